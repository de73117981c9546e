#!/usr/bin/env bash
# Install what checks need besides Python: compilers, an emulated board, analysers, a browser.
# For Debian and its kin; asks for root where it is not run as root. Nothing is installed twice.
set -euo pipefail

packages=(
  gcc g++ clang libclang-rt-dev cmake  # the exported C on the host, and its fuzzing
  gcc-arm-none-eabi libnewlib-arm-none-eabi  # the same for Cortex-M4F and M7
  qemu-system-arm                # boards to run it on
  cppcheck                       # with its MISRA C:2012 addon
  frama-c-base                   # Eva: no run-time error over the input box
  chromium                       # opens reports
  coq libzarith-ocaml-dev ocaml-findlib  # prove the theorem, replay certificates, and extract
)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' ||
    missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "system tools: all there"
else
  root=()
  [ "$(id -u)" -eq 0 ] || root=(sudo)
  "${root[@]}" apt-get update
  "${root[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get install --yes --no-install-recommends "${missing[@]}"
fi
"$(dirname "$0")/build-betaflight.sh"  # an autopilot to fly through
