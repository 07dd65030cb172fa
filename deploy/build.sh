#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds every program as a release: `bash deploy/build.sh [DIR]`, by default into build/release. Tests and micro
# benchmarks, a third of the work, are left to deploy/test.sh.
# Needs the packages of deploy/packages.txt (deploy/install_packages.sh); uses all cores.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/release}

cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release
cmake --build "$build" --target farfield-server farfield-client farfield-scene farfield-trace farfield-import farfield-bench farfield-load farfield-bake
echo "programs are in $build/bin"
