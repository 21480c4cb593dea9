#!/usr/bin/env bash
# Installs the build folder $1 to an empty prefix; builds and runs against it the consumer in $2, and
# the documented example in $3, which needs no library that core does not need; looks for the pages
# that --help names.
set -euo pipefail
build=$1
consumer=$2
example=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# build_against_prefix SOURCE BUILD [OPTION...]
build_against_prefix() {
  cmake -G Ninja -S "$1" -B "$2" -DCMAKE_PREFIX_PATH="$folder/prefix" \
    -DCMAKE_BUILD_TYPE=Release "${@:3}" >>"$folder/log" || { cat "$folder/log"; exit 1; }
  cmake --build "$2" >>"$folder/log" || { cat "$folder/log"; exit 1; }
}

cmake --install "$build" --prefix "$folder/prefix" >"$folder/log"
build_against_prefix "$consumer" "$folder/consumer"
"$folder/consumer/consumer"
build_against_prefix "$example" "$folder/example" --no-warn-unused-cli \
  -DCMAKE_DISABLE_FIND_PACKAGE_LZ4=ON -DCMAKE_DISABLE_FIND_PACKAGE_xxHash=ON \
  -DCMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=ON
"$folder/example/smooth_sphere"
pss=$folder/prefix/bin/pss
"$pss" --version

# Every page that --help names is installed where --help says, with the pages that it refers to.
pages=$folder/prefix/share/doc/pss
for command in smooth tile export convert info verify synth; do
  "$pss" "$command" --help
done >"$folder/help"
named=$(grep -oE 'docs/[a-z-]+\.md' "$folder/help" | sort -u)
grep -q share/doc/pss "$folder/help" || { echo "--help does not say where pages are"; exit 1; }
[ -n "$named" ] || { echo "--help names no page"; exit 1; }
for page in $named; do
  [ -s "$pages/${page#docs/}" ] || { echo "$page is named by --help but not installed"; exit 1; }
done
for page in $(grep -ohE '\]\([a-z-]+\.md\)' "$pages"/*.md | tr -d '](' | tr -d ')' | sort -u); do
  [ -s "$pages/$page" ] || { echo "$page is referred to but not installed"; exit 1; }
done
