#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds every program as a release: `bash deploy/build.sh [DIR]`, by default into build/release.
# Needs the packages of deploy/packages.txt (deploy/install_packages.sh); uses all cores.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=${1:-$root/build/release}

cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release
cmake --build "$build"
echo "programs are in $build/bin"
