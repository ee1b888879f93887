#!/usr/bin/env bash
# A newcomer's path through README, on a bare Debian 12 with nothing but git and this clone, as root: the demo, the page, a
# scene and a trace of one's own, a report, the package. Ends with the time that each step took; the goal is 10 minutes.
#
#   tools/newcomer.sh
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/.."
work=$(mktemp -d)
trap 'kill "${daemon:-}" 2>/dev/null || true; rm -rf "$work"' EXIT
names=() times=()

step() {
  local name=$1 began=$SECONDS
  shift
  printf '\n==== %s: %s\n' "$name" "$*"
  "$@"
  names+=("$name")
  times+=($((SECONDS - began)))
}

demo() { ./dev demo; }

# fetch ADDRESS PATH [HEADER]: without a program that a bare machine lacks.
fetch() {
  exec 3<>"/dev/tcp/${1%:*}/${1##*:}"
  printf 'GET %s HTTP/1.1\r\nHost: %s\r\nConnection: close\r\n%s\r\n' "$2" "$1" "${3:+$3$'\r\n'}" >&3
  cat <&3
  exec 3>&-
}

# The page of a daemon that plays tests: `stickslip status` says its address, and the file in which the token stands.
page() {
  cat >"$work/page.toml" <<TOML
[board]
driver = "simulated"
[board.simulated]
scenes = ["$PWD/config/scenes/stick-slip-at-12-in-per-min.toml"]
repeats = 0
[record]
folder = "$work/records"
[control]
socket = "$work/control.sock"
http = "127.0.0.1:0"
token_file = "$work/token"
TOML
  stickslipd --config "$work/page.toml" 2>"$work/log" &
  daemon=$!
  local address=
  until address=$(grep -oE '127\.0\.0\.1:[0-9]+' "$work/log"); do
    kill -0 "$daemon"
    sleep 0.1
  done
  fetch "$address" / >"$work/page"
  grep -o '<title>.*</title>' "$work/page"
  fetch "$address" /v1/status "Authorization: Bearer $(cat "$work/token")" >"$work/status"
  grep -o '"state": *"[^"]*"' "$work/status"
  stickslip status --socket "$work/control.sock"
  kill "$daemon"
  wait "$daemon"
}

own_scene() {
  stickslip simulate stick-slip-at-12-in-per-min -o "$work/pull.h5" --set paper.mu_s=0.34 --seed 7
  stickslip analyze "$work/pull.h5"
}

# Force as another program writes it: a saw-tooth of 2 Hz, sampled 500 times a second.
own_trace() {
  awk 'BEGIN { print "time,mu"; for (i = 0; i < 5000; ++i) { p = (i % 250) / 250; print i / 500 "," 0.3 + (p < 0.95 ? 0.1 * p : 0.1 * (1 - p) * 19) } }' >"$work/trace.csv"
  stickslip import "$work/trace.csv" --column mu --rate "500 Hz" --unit coefficient -o "$work/trace.h5"
  stickslip analyze "$work/trace.h5"
}

report() {
  stickslip report records/demo/*.h5 -o "$work/demo.html"
  grep -q '<html' "$work/demo.html"
}

package() {
  ./dev package
  apt-get -qq -y --no-install-recommends install ./build/package/stickslip_*.deb >"$work/apt" 2>&1 || { cat "$work/apt"; return 1; }
  /usr/bin/stickslip demo --folder "$work/installed" | tail -n 4
}

step "the demo" demo
export PATH="$PWD/build/release/bin:$PATH"
step "the charts of the pages" ./dev build release pages
step "the page" page
step "a scene of one's own" own_scene
step "a trace of one's own" own_trace
step "a report" report
step "the package" package

printf '\n==== a newcomer needed (%d processors)\n' "$(nproc)"
for i in "${!names[@]}"; do printf '%-24s %5d s\n' "${names[i]}" "${times[i]}"; done
printf '%-24s %5d s\n' "all" "$SECONDS"
