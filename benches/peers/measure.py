"""Distances between pictures: arrays of height x width x 3, linear."""
import numpy as np

# Added to the square of the reference, so that dark pixels do not rule the mean.
EPSILON = 1e-2


def read_exr(path):
    """The beauty of an EXR as an array, and its alpha."""
    import OpenEXR

    with OpenEXR.File(str(path)) as file:
        channels = file.parts[0].channels
        pixels = channels["RGBA"].pixels if "RGBA" in channels else np.stack(
            [channels[c].pixels for c in "RGBA"], axis=-1)
    return pixels[..., :3].astype(np.float64), pixels[..., 3].astype(np.float64)


def rel_mse(picture, reference, mask):
    """Mean over masked pixels and colors of the squared error over the squared reference."""
    error = (picture - reference) ** 2 / (reference ** 2 + EPSILON)
    return float(error[mask].mean())


def blurred(picture, size):
    """Means of squares of pixels, the picture cut to whole ones."""
    h, w = picture.shape[0] // size * size, picture.shape[1] // size * size
    cut = picture[:h, :w].reshape(h // size, size, w // size, size, -1)
    return cut.mean(axis=(1, 3))


def write_png(path, picture):
    """Plain sRGB, cut at white, by the standard library alone."""
    import struct
    import zlib

    x = np.clip(picture, 0, 1)
    x = np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)
    bytes_ = (x * 255 + 0.5).astype(np.uint8)
    height, width = bytes_.shape[:2]
    rows = b"".join(b"\0" + bytes_[y].tobytes() for y in range(height))

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    with open(path, "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)))
        out.write(chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
