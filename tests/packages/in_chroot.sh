#!/usr/bin/env bash
# The packages of `./x package` as a stranger uses them: in a bare Debian 12 (debootstrap, as root) they are installed,
# the program, a C++ project and Python run a scene, then all is removed without a trace. in_chroot.sh [FOLDER]
set -euo pipefail
root=$(cd -- "$(dirname -- "$0")/../.." && pwd)
chroot=${1:-$(mktemp -d)/debian}
mirror=${CLEAVE_MIRROR:-http://deb.debian.org/debian}
[[ -d $chroot/etc ]] || debootstrap --variant=minbase bookworm "$chroot" "$mirror" >/dev/null
inside() { chroot "$chroot" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"; }
cp /etc/resolv.conf "$chroot/etc/"
cp /etc/apt/apt.conf.d/*prox* "$chroot/etc/apt/apt.conf.d/" 2>/dev/null || true
rm -rf "$chroot/root/packages" "$chroot/root/consumer"
mkdir "$chroot/root/packages"
cp "$root"/build/packages/*.deb "$chroot/root/packages/"
cp -r "$root/examples/consumer" "$chroot/root/consumer"
cp "$root/examples/wedge_slope/wedge_slope.toml" "$chroot/root/"

inside apt-get update >/dev/null
inside bash -c 'apt-get install -y --no-install-recommends /root/packages/*.deb cmake g++ make pkg-config man-db' >/dev/null

echo "== program"
inside cleave run /root/wedge_slope.toml -o /root/out --quiet
inside grep -o '"factor_of_safety\|"hash": "[0-9a-f]*"' /root/out/summary.json | head -n 1
[[ $(inside cut -d, -f5,11 /root/out/key_blocks.csv | tail -n 1) == wedge,* || $(inside cat /root/out/key_blocks.csv) == *wedge* ]]
inside man -P cat cleave | head -n 4 || inside test -s /usr/share/man/man1/cleave.1
inside test -s /usr/share/bash-completion/completions/cleave

echo "== C++: find_package and pkg-config"
inside bash -c 'cmake -S /root/consumer -B /root/consumer/build >/dev/null && cmake --build /root/consumer/build >/dev/null && /root/consumer/build/consumer'
inside bash -c 'g++ -std=c++23 /root/consumer/main.cpp $(pkg-config --cflags --libs cleave-topology) -o /root/consumer/by_pkg_config && /root/consumer/by_pkg_config'

echo "== Python"
inside test -d /usr/lib/python3/dist-packages/cleave/__pycache__
inside /usr/bin/python3 -c 'import cleave; r = cleave.run("/root/wedge_slope.toml"); print(cleave.__version__, len(r.blocks), r.key_blocks["factor_of_safety"][0])'

inside apt-get purge -y cleave libcleave0 libcleave-dev python3-cleave >/dev/null
left=$(inside find / -xdev -path '*cleave*' -not -path '/root/*' -not -path '/proc/*' -not -path '/var/cache/man/*' | sort)
[[ -z $left ]] || { echo "left behind: $left"; exit 1; }
echo "packages: installed, used, removed without a trace"
