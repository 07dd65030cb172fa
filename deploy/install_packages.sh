#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what deploy/packages.txt lists; does nothing, and needs no rights, when everything is there already.
# As root, or through sudo without a password prompt where there is no terminal.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

say() { echo "install_packages: $*" >&2; }

mapfile -t wanted < <(sed -e 's/#.*//' -e 's/[[:space:]]*$//' -e '/^$/d' "$here/packages.txt")

missing=()
for package in "${wanted[@]}"; do
  state=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $state == installed ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

if ! command -v apt-get >/dev/null; then
  say "this system has no apt-get: install the counterparts of these Debian 12 packages by hand: ${missing[*]}"
  exit 1
fi
as_root=()
if [[ $(id -u) -ne 0 ]]; then
  if ! command -v sudo >/dev/null; then
    say "run it as root, or install sudo; missing packages: ${missing[*]}"
    exit 1
  fi
  as_root=(sudo)
  [[ -t 0 ]] || as_root=(sudo -n)
fi

say "installing ${#missing[@]} packages: ${missing[*]}"
export DEBIAN_FRONTEND=noninteractive
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3)
if ! "${apt[@]}" update >&2; then
  say "apt-get update failed: check the network and /etc/apt/sources.list"
  exit 1
fi
if ! "${apt[@]}" install -y --no-install-recommends "${missing[@]}" >&2; then
  say "apt-get install failed; its own message stands above. Farfield expects Debian 12 (bookworm)"
  exit 1
fi
