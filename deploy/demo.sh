#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# One command from a bare Debian 12 to a walk through a real model, over a real socket. `bash deploy/demo.sh --help`.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

usage() {
  cat <<'TEXT'
Usage: bash deploy/demo.sh [--scene SCENE] [--out DIR] [--seconds S] [--programs DIR]

Installs what is missing, builds, serves a model and walks through it. With a display a window shows the walk; without
one the walk is drawn without a screen: images, one contact sheet (the client's frames above the truth) and a table of
what was measured. It ends by itself and leaves nothing running.

  --scene SCENE   your own model: .glb .gltf .obj .ply .stl .off .dae .ac .ifc .city.json .jsonl, or a generated one as
                  KIND:TRIANGLES:SEED; default: a warship of 180,000 triangles (Debian's flightgear-data-models, a
                  download of 144 MB, kept in ~/.cache/farfield)
  --out DIR       where trace, images and logs go (default: out/demo)
  --seconds S     length of the walk (default: 12)
  --programs DIR  take the programs built there instead of installing and building
TEXT
}

scene=
out=$root/out/demo
seconds=12
bin=
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --scene | --out | --seconds | --programs)
      [[ $# -ge 2 ]] || { echo "demo: $1 needs a value; see --help" >&2; exit 2; }
      case $1 in
        --scene) scene=$2 ;;
        --out) out=$2 ;;
        --seconds) seconds=$2 ;;
        --programs) bin=$2 ;;
      esac
      shift 2 ;;
    *) echo "demo: there is no option $1; see --help" >&2; exit 2 ;;
  esac
done
[[ $seconds =~ ^[1-9][0-9]*$ ]] || { echo "demo: --seconds $seconds: write a whole number from 1" >&2; exit 2; }

say() { echo "demo: $*" >&2; }
scratch=$(mktemp -d)
server=
finish() {
  if [[ -n $server ]]; then
    kill "$server" 2>/dev/null || true
    wait "$server" 2>/dev/null || true
  fi
  rm -rf "$scratch"
}
trap finish EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# ── a model ──

package=flightgear-data-models
model_in_package=usr/share/games/flightgear/Models/Maritime/Military/CG-57-high-detail
cache=${XDG_CACHE_HOME:-$HOME/.cache}/farfield

# Prints the path of the warship, fetched once; fails where Debian's archive cannot be reached.
fetch_warship() {
  local model=$cache/CG-57-high-detail/CG-57.ac
  if [[ ! -s $model ]]; then
    say "fetching Debian's $package (144 MB, once)"
    mkdir -p "$cache"
    (cd "$scratch" && apt-get -q -o APT::Sandbox::User=root download "$package" >&2) || return 1
    # The folder appears complete or not at all, should this be interrupted.
    mkdir "$scratch/package"
    dpkg-deb --fsys-tarfile "$scratch/$package"_*.deb |
      tar -x -C "$scratch/package" "./$model_in_package" "./usr/share/doc/$package/copyright" || return 1
    rm -rf "$cache/CG-57-high-detail" "$cache/incomplete"
    cp -rL "$scratch/package/$model_in_package" "$cache/incomplete" || return 1
    cp "$scratch/package/usr/share/doc/$package/copyright" "$cache/incomplete/" || return 1
    mv "$cache/incomplete" "$cache/CG-57-high-detail"
    rm -rf "$scratch/package" "$scratch"/*.deb
  fi
  [[ -s $model ]] && echo "$model"
}

if [[ -z $bin ]]; then
  bash "$root/deploy/install_packages.sh"
  say "building (the first time takes a while)"
  if ! bash "$root/deploy/build.sh" >"$scratch/build.log" 2>&1; then
    tail -n 30 "$scratch/build.log" >&2
    say "the build failed"
    exit 1
  fi
  bin=$root/build/release/bin
fi
mkdir -p "$out"

if [[ -z $scene ]]; then
  if ! scene=$(fetch_warship); then
    say "$package cannot be had; a generated plant of a million triangles stands in for the warship"
    scene=pipes:1000000:1
  fi
fi

# ── a walk ──

trace=$out/walk.trace
for kind in walk fly orbit; do
  if "$bin/farfield-trace" generate "$scene" --kind "$kind" --seconds "$seconds" --output "$trace" >"$out/trace.txt" 2>"$out/trace.log"; then
    say "a $kind of $seconds s: $trace"
    break
  fi
  [[ $kind != orbit ]] || { cat "$out/trace.log" >&2; exit 1; }
done

# ── a server, on any free port ──

"$bin/farfield-server" --scene "demo=$scene" --listen 127.0.0.1:0 >"$out/server.out" 2>"$out/server.log" &
server=$!
endpoint=
while [[ -z $endpoint ]]; do
  if ! kill -0 "$server" 2>/dev/null; then
    tail -n 1 "$out/server.log" >&2
    server=
    exit 1
  fi
  sleep 0.1
  endpoint=$(sed -n 's/^listening at //p' "$out/server.out")
done
say "farfield-server serves $scene at $endpoint"

# ── the client ──

if [[ -n ${DISPLAY:-}${WAYLAND_DISPLAY:-} ]]; then
  "$bin/farfield-client" --connect "$endpoint" --trace "$trace"
  exit
fi

say "no display: drawing without a screen"
"$bin/farfield-client" --connect "$endpoint" --headless --trace "$trace" --quiet | tee "$out/real_time.txt"
"$bin/farfield-client" --connect "$endpoint" --headless --trace "$trace" --lockstep --frames 24 --frames-dir "$out/frames" \
  --quiet >"$out/lockstep.txt"
kill "$server"
wait "$server" || true
server=

say "comparing six frames with the truth (rays straight into the scene, 16 per pixel)"
"$bin/farfield-bench" --scene "$scene" --trace "$trace" --frames 6 --methods rays,farfield-cpu --no-realtime --border-pairs 0 \
  --contact-sheet "$out/contact_sheet.png" --json "$out/bench.json" 2>"$out/bench.log" >"$out/bench.txt" ||
  { tail -n 3 "$out/bench.log" >&2; exit 1; }
[[ -s $out/contact_sheet.png ]] || { say "no contact sheet was written"; exit 1; }
cut -c 1-100 "$out/bench.txt"
say "images: $out/frames; contact sheet: $out/contact_sheet.png"
