#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Three servers, one Redis, one HAProxy, and a server killed under load. `bash deploy/scale_out.sh --help`.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

usage() {
  cat <<'TEXT'
Usage: bash deploy/scale_out.sh [--walkers N] [--paths N] [--seconds S] [--scene SCENE] [--face-tiles N] [--cold] [--programs DIR] [--json FILE] [--keep DIR]

Starts Redis and HAProxy (Debian's packages, deploy/haproxy/haproxy.cfg) and three farfield-servers on loopback, bakes
the paths into Redis, walks viewers through the servers, kills one of them in the middle with SIGKILL, and reports.
Fails (exit 1) if

  a viewer was without a server for 2 s or longer, one who is at the end of the run included,
  a viewer never connected, or anything arrived damaged,
  something was made twice by the servers that lived: cells are made by one server and shared through Redis.

What the killed server was making when it died is made again by another, and told apart.

  --walkers N     viewers at 1.4 m/s (default: 100)
  --paths N       different paths they walk (default: 20)
  --seconds S     length of the run (default: 60)
  --scene SCENE   model file or KIND:TRIANGLES:SEED (default: pipes:200000:1)
  --face-tiles N  tiles along a face's edge (default: 4, a third of what a 720p display needs, so that two cores bake 20
                  paths in about a minute)
  --cold          bake nothing: all cells are made while viewers wait for them, by whichever server is asked first
  --programs DIR  where farfield-server, farfield-load and farfield-trace are (default: build/release/bin)
  --json FILE     write the report as JSON
  --keep DIR      keep logs and reports there
TEXT
}

walkers=100 paths=20 seconds=60 scene=pipes:200000:1 face_tiles=4 is_cold= bin=$root/build/release/bin json= keep=
while [[ $# -gt 0 ]]; do
  case $1 in
    -h | --help) usage; exit 0 ;;
    --cold) is_cold=yes; shift ;;
    --walkers | --paths | --seconds | --scene | --face-tiles | --programs | --json | --keep)
      [[ $# -ge 2 ]] || { echo "scale_out: $1 needs a value; see --help" >&2; exit 2; }
      case $1 in
        --walkers) walkers=$2 ;;
        --paths) paths=$2 ;;
        --seconds) seconds=$2 ;;
        --scene) scene=$2 ;;
        --face-tiles) face_tiles=$2 ;;
        --programs) bin=$2 ;;
        --json) json=$2 ;;
        --keep) keep=$2 ;;
      esac
      shift 2 ;;
    *) echo "scale_out: there is no option $1; see --help" >&2; exit 2 ;;
  esac
done
for number in "$walkers" "$paths" "$seconds" "$face_tiles"; do
  [[ $number =~ ^[1-9][0-9]*$ ]] || { echo "scale_out: $number: write a whole number from 1" >&2; exit 2; }
done
say() { echo "scale_out: $*" >&2; }
fail() { say "$*"; exit 1; }
for program in redis-server redis-cli haproxy curl jq; do
  PATH=$PATH:/usr/sbin command -v "$program" >/dev/null || fail "$program is missing: bash deploy/install_packages.sh"
done
PATH=$PATH:/usr/sbin

work=$(mktemp -d)
declare -A process
finish() {
  for name in "${!process[@]}"; do kill "${process[$name]}" 2>/dev/null || true; done
  wait 2>/dev/null || true
  if [[ -n $keep ]]; then mkdir -p "$keep" && cp -r "$work/." "$keep/"; fi
  rm -rf "$work"
}
trap finish EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

# A port nobody listens at. Between this and its use somebody might take it; then the program that wanted it says so and the run fails.
free_port() {
  local port
  while :; do
    port=$((20000 + RANDOM % 12000))
    (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null || { echo "$port"; return; }
  done
}
until_true() { # SECONDS COMMAND…: until the command succeeds
  local deadline=$((SECONDS + $1))
  shift
  until "$@" >/dev/null 2>&1; do
    ((SECONDS < deadline)) || return 1
    sleep 0.1
  done
}
metric() { # NAME LABEL FILE: the sum over all lines with the label
  awk -v name="$1" -v label="$2" 'index($1, name) == 1 && (label == "" || index($1, label)) { sum += $2 } END { printf "%.0f", sum }' "$3"
}
scrape() { curl -sf --max-time 2 "http://127.0.0.1:${admin[$1]}/metrics" -o "$work/metrics.$2"; }

# ── what runs ──

say "paths through $scene"
"$bin/farfield-trace" generate "$scene" --count "$paths" --seconds 12 -o "$work/walks" >"$work/trace.log" 2>&1 || fail "no paths: $(tail -n 1 "$work/trace.log")"

redis=$(free_port)
redis-server --port "$redis" --bind 127.0.0.1 --save '' --appendonly no --dir "$work" --maxmemory 2gb --maxmemory-policy allkeys-lru \
  >"$work/redis.log" 2>&1 &
process[redis]=$!
until_true 10 redis-cli -p "$redis" ping || fail "Redis does not answer: $(tail -n 1 "$work/redis.log")"

baked_tiles=0 baked_leaves=0
if [[ -z $is_cold ]]; then
  say "baking them into Redis"
  "$bin/farfield-bake" --scene "$scene" --redis "127.0.0.1:$redis" --face-tiles "$face_tiles" --trace "$work/walks" --json >"$work/bake.json" \
    2>"$work/bake.log" || fail "not baked: $(tail -n 1 "$work/bake.log")"
  baked_tiles=$(jq .tiles.made "$work/bake.json") baked_leaves=$(jq .leaves "$work/bake.json")
fi

declare -A stream admin
for name in 1 2 3; do
  stream[$name]=$(free_port) admin[$name]=$(free_port)
  "$bin/farfield-server" --scene "$scene" --listen "127.0.0.1:${stream[$name]}" --admin "127.0.0.1:${admin[$name]}" --memory 512MiB --face-tiles "$face_tiles" \
    --redis "127.0.0.1:$redis" >"$work/server.$name.out" 2>"$work/server.$name.log" &
  process[server$name]=$!
  export "FARFIELD_SERVER_$name=127.0.0.1:${stream[$name]}" "FARFIELD_HEALTH_HOST_$name=127.0.0.1" "FARFIELD_HEALTH_PORT_$name=${admin[$name]}"
done
for name in 1 2 3; do
  until_true 300 curl -sf "http://127.0.0.1:${admin[$name]}/readyz" || fail "server $name is not ready: $(tail -n 1 "$work/server.$name.log")"
done

front=$(free_port)
export FARFIELD_LISTEN=127.0.0.1:$front FARFIELD_STATUS=127.0.0.1:$(free_port)
haproxy -f "$root/deploy/haproxy/haproxy.cfg" >"$work/haproxy.log" 2>&1 &
process[haproxy]=$!
until_true 10 bash -c "exec 3<>/dev/tcp/127.0.0.1/$front" || fail "HAProxy does not listen: $(tail -n 1 "$work/haproxy.log")"

# ── the run ──

say "$walkers viewers for $seconds s, server 1 killed after $((seconds / 2)) s"
"$bin/farfield-load" --connect "127.0.0.1:$front" --clients "$walkers" --arrival 20/s --seconds "$seconds" --walk "trace:$work/walks" --speed 1.4 \
  --json "$work/load.json" >"$work/load.out" 2>"$work/load.log" &
process[load]=$!
sleep "$((seconds / 2))"
scrape 1 killed || fail "server 1 does not answer before it is to be killed"
kill -KILL "${process[server1]}"
wait "${process[server1]}" 2>/dev/null || true
unset 'process[server1]'
wait "${process[load]}" || fail "farfield-load: $(tail -n 1 "$work/load.log")"
unset 'process[load]'
for name in 2 3; do scrape "$name" "$name" || fail "server $name does not answer after the run"; done
redis-cli -p "$redis" --scan --pattern 'ff:*' | cut -c 4 | sort | uniq -c >"$work/keys"

# ── the report ──

kept() { awk -v kind="$1" '$2 == kind { print $1 }' "$work/keys" | grep . || echo 0; }
tiles_kept=$(kept t) plans_kept=$(kept p)
declare -A tiles plans sessions
twice=0 alone=0
for name in killed 2 3; do
  tiles[$name]=$(metric farfield_tiles_made_total '' "$work/metrics.$name")
  plans[$name]=$(metric farfield_leaf_plans_made_total '' "$work/metrics.$name")
  twice=$((twice + $(metric farfield_store_rewritten_total 'tier="redis"' "$work/metrics.$name")))
  alone=$((alone + $(metric farfield_leases_missing_total '' "$work/metrics.$name")))
done
[[ $tiles_kept -gt 0 ]] || fail "nothing was stored in Redis"
made=$((baked_tiles + tiles[killed] + tiles[2] + tiles[3]))
jq -n --slurpfile load "$work/load.json" --argjson tiles "{\"killed\":${tiles[killed]},\"two\":${tiles[2]},\"three\":${tiles[3]}}" \
  --argjson baked "{\"tiles\":$baked_tiles,\"plans\":$baked_leaves}" --argjson plans "{\"killed\":${plans[killed]},\"two\":${plans[2]},\"three\":${plans[3]}}" \
  --argjson kept "{\"tiles\":$tiles_kept,\"plans\":$plans_kept}" --argjson twice "$twice" --argjson alone "$alone" \
  '{format: "farfield-scale-out/1", walkers: $load[0].clients, seconds: $load[0].seconds, away_ms: $load[0].away_ms, reconnects: $load[0].reconnects,
    errors: $load[0].errors, first_picture_ms: $load[0].first_picture_ms, cell_ready_ms: $load[0].cell_ready_ms, late_share: $load[0].late_share,
    baked: $baked, tiles_made: $tiles, plans_made: $plans, kept: $kept, made_twice: $twice, made_without_lease: $alone}' >"$work/report.json"
if [[ -n $json ]]; then cp "$work/report.json" "$json"; fi

away=$(jq '.away_ms.max // 0' "$work/report.json")
reconnects=$(jq .reconnects "$work/report.json")
lost=$(jq '[.errors | to_entries[] | select(.key == "never_connected" or .key == "bad_payload") | .value] | add // 0' "$work/report.json")
cat <<TEXT
viewers          $walkers on $paths paths, $seconds s; server 1 killed after $((seconds / 2)) s
lost their server $reconnects times; longest without one: $away ms
errors           $(jq -c .errors "$work/report.json")
cell ready       p50 $(jq '.cell_ready_ms.p50 // "none"' "$work/report.json") ms, p95 $(jq '.cell_ready_ms.p95 // "none"' "$work/report.json") ms; late on $(jq '.late_share * 1000 | round / 10' "$work/report.json") % of frames
tiles made       $made: $baked_tiles baked, ${tiles[killed]} by the server that was killed, ${tiles[2]} and ${tiles[3]} by the others; $tiles_kept different ones in Redis
leaves planned   $((baked_leaves + plans[killed] + plans[2] + plans[3])): $baked_leaves baked, ${plans[killed]}, ${plans[2]}, ${plans[3]}; $plans_kept different ones in Redis
made twice       $twice by servers that lived; made without a lease: $alone
TEXT
jq -e --argjson away "$away" -n '$away < 2000' >/dev/null || fail "a viewer was without a server for $away ms"
[[ $lost -eq 0 ]] || fail "viewers were lost or got damaged bytes: $(jq -c .errors "$work/report.json")"
[[ $twice -eq 0 ]] || fail "$twice tiles or plans were made twice"
say "kept: nobody without a server for 2 s, everything made once"
