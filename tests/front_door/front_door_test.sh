#!/bin/sh
# SPDX-FileCopyrightText: The Isophote authors
# SPDX-License-Identifier: Apache-2.0
# Tests ./isophote and tools/check-layers in a copy of the checkout whose tools are fakes: no package is touched.
# Usage: front_door_test.sh SOURCE_FOLDER
set -u
source_folder=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0

expect() { # expect WHAT COMMAND...: the command must succeed.
  what=$1
  shift
  if "$@"; then printf 'ok      %s\n' "$what"; else
    printf 'FAILED  %s\n' "$what"
    failures=$((failures + 1))
    for file in "$work/out" "$work/err" "$work/calls"; do
      [ -e "$file" ] && { printf -- '--- %s\n' "$file"; cat "$file"; }
    done
  fi
}
holds() { grep -q -- "$2" "$1"; }
lacks() { ! grep -q -- "$2" "$1"; }
is_empty() { [ ! -s "$1" ]; }

fake() { # fake NAME: an executable on the fake PATH whose script is on stdin; it notes each call.
  { printf '#!/bin/sh\necho "%s $*" >>"%s/calls"\n' "$1" "$work"; cat; } >"$work/fakes/$1"
  chmod +x "$work/fakes/$1"
}

run() { # run ARGS...: ./isophote ARGS with the fake tools only.
  : >"$work/calls"
  PATH=$work/fakes:$work/system "$work/checkout/isophote" "$@" >"$work/out" 2>"$work/err"
  code=$?
}

# A checkout with the front door and no sources, and a PATH without package manager or compiler.
mkdir -p "$work/checkout" "$work/fakes" "$work/system"
cp -r "$source_folder/isophote" "$source_folder/tools" "$work/checkout/"
mkdir -p "$work/checkout/cmake" "$work/checkout/src" "$work/checkout/tests" "$work/checkout/benchmarks"
touch "$work/checkout/CMakeLists.txt" "$work/checkout/CMakePresets.json"
for tool in sh cat chmod cksum dirname env find flock grep id mkdir mv rm sed tail touch; do
  path=$(command -v "$tool") && ln -s "$path" "$work/system/$tool"
done

run --help
expect 'help of an unbuilt checkout builds nothing' test $code = 0
expect 'and says what the first use does' holds "$work/out" 'apt-get'

run info
expect 'without apt-get it stops' test $code = 1
expect 'and lists the packages' holds "$work/err" 'libembree-dev'
expect 'and keeps stdout clean' is_empty "$work/out"

# A Debian system that lacks two packages. The fake ninja "builds" a program that shows its arguments.
fake dpkg-query <<'E2'
for package; do :; done
case $package in libembree-dev | glslc) exit 1 ;; *) echo installed ;; esac
E2
fake apt-get </dev/null
fake sudo <<'E2'
exec "$@"
E2
fake cmake <<'E2'
touch build/release/build.ninja
E2
fake ninja <<E2
mkdir -p "$work/checkout/build/release/bin"
printf '#!/bin/sh\nprintf "<%%s>" "\$@"\necho "assets \$ISOPHOTE_ASSETS" >>"$work/calls"\nexit 3\n' >"$work/checkout/build/release/bin/isophote"
chmod +x "$work/checkout/build/release/bin/isophote"
E2

run info 'a b' '*'
expect 'apt-get update comes first' holds "$work/calls" 'apt-get update'
expect 'only what is missing is installed' holds "$work/calls" 'no-install-recommends glslc libembree-dev *$'
expect 'only the program is built' holds "$work/calls" 'release isophote$'
expect 'the exit code is the program'"'"'s' test $code = 3
expect 'arguments arrive untouched' test "$(cat "$work/out")" = '<info><a b><*>'

run info
expect 'a second run asks no package manager' lacks "$work/calls" 'dpkg-query\|apt-get\|cmake'
expect 'and says nothing' is_empty "$work/err"

mkdir -p "$work/shared/scenes"
unset ISOPHOTE_ASSETS
run info
expect 'scenes beside the checkout are found' holds "$work/calls" 'assets .*/checkout/../shared/scenes$'
ISOPHOTE_ASSETS=/elsewhere
export ISOPHOTE_ASSETS
run info
expect 'unless a person names others' holds "$work/calls" 'assets /elsewhere$'

echo '# changed' >>"$work/checkout/tools/packages"
run info
expect 'a changed package list is looked at again' holds "$work/calls" 'dpkg-query'

fake ninja <<'E2'
echo "scene.cpp:1: error: words of the compiler"
exit 1
E2
run info
expect 'a failed build stops' test $code = 1
expect 'and shows the words of the compiler' holds "$work/err" 'words of the compiler'
expect 'and runs no program' is_empty "$work/out"
fake ninja </dev/null
run info
expect 'and has the packages looked at the next time' holds "$work/calls" 'dpkg-query'

# Layers.
layers() { "$source_folder/tools/check-layers" "$work/layers" >"$work/out" 2>&1; }
file() { # file PATH LINE: a source file of one line.
  mkdir -p "$work/layers/$(dirname "$1")" && printf '%s\n' "$2" >"$work/layers/$1"
}
file math/a.h '#include "base/error.h"'
file stages/direct/direct_cpu.cpp '#include "stages/gbuffer/view_samples.h"'
file stages/direct/direct_test.cpp '#include "stages/gbuffer/gbuffer.h"'
expect 'includes in order pass' layers
file base/b.h '#include "math/a.h"'
expect 'an upward include is refused' eval '! layers'
expect 'and named with file and line' holds "$work/out" 'src/base/b.h:1: .*base must not know math'
rm "$work/layers/base/b.h"
file gpu/i.h '#include "trace/trace_scene.h"'
expect 'neighbours do not know each other' eval '! layers'
rm "$work/layers/gpu/i.h"
file stages/direct/direct.h '#include "stages/gbuffer/gbuffer.h"'
expect 'a stage knows no other stage' eval '! layers'

[ $failures = 0 ]
