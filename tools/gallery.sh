#!/usr/bin/env bash
# Remakes the pictures of docs/gallery.md by the very commands that stand there.
# tools/gallery.sh PROGRAM FOLDER: the built stickslip; where the pictures go, replacing those that are there.
set -euo pipefail
program=$(readlink -f "$1")
folder=$(readlink -f "$2")
document=$(dirname "$(readlink -f "$0")")/../docs/gallery.md

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# shellcheck disable=SC2016 # the backticks are those of the document
commands=$(sed -n '/^```sh$/,/^```$/{/^stickslip plot /p}' "$document")
count=0
while read -r name rest; do
  # Words of the document, split as the shell would; nothing in them is replaced.
  mapfile -t arguments < <(xargs -n 1 printf '%s\n' <<<"$rest")
  [ "$name" = stickslip ] || continue
  (cd "$work" && "$program" "${arguments[@]}" >/dev/null)
  count=$((count + 1))
done <<<"$commands"
mv "$work"/*.svg "$folder"
printf '%s\n' "gallery: $count pictures in $folder" >&2
