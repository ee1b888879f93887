#!/usr/bin/env bash
# lint/run.sh BUILD_DIRECTORY: every static check; runs all of them, fails if any does.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
build=${1:?a configured build directory, for its compile_commands.json}
failed=0

check() {
  local name=$1 began=$SECONDS
  shift
  if "$@"; then
    echo "lint: $name: clean ($((SECONDS - began)) s)"
  else
    echo "lint: $name: FAILED ($((SECONDS - began)) s)" >&2
    failed=1
  fi
}

# shellcheck disable=SC2317  # the functions below are called by check
formatted() { git ls-files -z '*.cpp' '*.hpp' | xargs -0 -r clang-format --dry-run -Werror; }

# shellcheck disable=SC2317
scripts_are_sound() { git grep -lzE '^#!.*\b(ba)?sh$' -- . | xargs -0 -r shellcheck; }

# What the programs are made with, by ./dev, against the tables with licences.
# shellcheck disable=SC2317
dependencies_are_listed() {
  local package missing=0
  while read -r package; do
    grep -E '^\|' docs/dependencies.md | tr '|,' '\n' | tr -d ' ' | grep -qxF "$package" && continue
    echo "docs/dependencies.md lacks $package" >&2
    missing=1
  done < <(sed -n '/^build_packages=(/,/^)/p; /build_packages+=(/p; /^run_packages=(/p' dev | sed 's/#.*//; s/.*(//; s/).*//' | xargs -n 1)
  return "$missing"
}

# One file per process, as many processes as processors. The files are those that the build compiles, most of them
# bunches of sources, .cxx, and not what is generated; headers are checked through them. Tests, half of the time, are left
# to GCC's warnings. So is shadowing: a bunch has names of several sources, and -Werror would not let the configuration
# leave it out. stderr only counts suppressed warnings.
# shellcheck disable=SC2317
tidy() {
  sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' "$build/compile_commands.json" | sort -u |
    grep -v -e "^$(realpath "$build")/.*\.cpp$" -e /tests/ |
    xargs -r -P "$(nproc)" -n 1 clang-tidy -p "$build" --extra-arg=-Wno-shadow --quiet 2>/dev/null
}

# A folder's README fits a screen (CONTRIBUTING.md).
# shellcheck disable=SC2317
readmes_are_short() {
  find core drivers io report daemon cli tests bench -name README.md -exec awk '
    END { if (NR > 30) { print FILENAME ": " NR " lines, 30 are allowed"; exit 1 } }' {} \; | (! grep .)
}

check "who includes whom" python3 tools/lint/include_table.py
check "READMEs of folders" readmes_are_short
check "clang-format" formatted
check "shellcheck" scripts_are_sound
check "dependencies" dependencies_are_listed
check "clang-tidy" tidy
exit "$failed"
