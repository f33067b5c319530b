"""Looks azimuths up, as docs/table-format.md prints it. Needs numpy."""
import numpy as np


def azimuths(head, psi_deg):
    """The two azimuths that bracket a query's: [(azimuth, mirrored, share), ...]."""
    count, symmetry = head["vair:azimuths"], head["vair:symmetry"]
    start, end = {"both-axes": (0, 90), "minor-axis": (-90, 90), "none": (0, 360)}[symmetry]
    period = count if symmetry == "none" else 2 * count
    x = (psi_deg - start) / (end - start) * count - 0.5
    below = int(np.floor(x))
    found = []
    for k, share in ((below, below + 1 - x), (below + 1, x - below)):
        k %= period
        found.append((k, False, share) if k < count else (period - 1 - k, True, share))
    return found
