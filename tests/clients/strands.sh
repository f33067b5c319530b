#!/bin/sh
# Has plain strands read by the libraries of others: tests/clients/strands.sh STEM
# STEM.npz, .ply, .hair and .glb are one groom. What is needed goes into target/strand-clients.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
clients="$here/../../target/strand-clients"
mkdir -p "$clients"
clients=$(cd "$clients" && pwd)
if ! [ -e "$clients/ready" ]; then
    python3 -m venv "$clients/python"
    "$clients/python/bin/pip" install --quiet --disable-pip-version-check numpy==2.4.6 plyfile==1.1.5 pygltflib==1.16.5
    npm install --silent --no-audit --no-fund --prefix "$clients" gltf-validator@2.0.0-dev.3.10
    touch "$clients/ready"
fi
"$clients/python/bin/python" -B "$here/check_strands.py" "$1"
# Khronos's own checks.
NODE_PATH="$clients/node_modules" node -e '
const file = process.argv[1];
require("gltf-validator").validateBytes(new Uint8Array(require("fs").readFileSync(file)), { maxIssues: 20 })
    .then((report) => {
        const issues = report.issues;
        for (const message of issues.messages) console.log(JSON.stringify(message));
        const bad = issues.numErrors + issues.numWarnings;
        console.log(`${bad ? "FAIL" : "OK"} ${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings, ${issues.numInfos} infos, ${issues.numHints} hints`);
        process.exit(bad ? 1 : 0);
    });
' "$1.glb"
