#!/bin/sh
# cmake/ccache.sh COMPILER ARGUMENT...: compiles through ccache, but for clang's precompiled headers.
#
# These name the files that they were made of with their folder. One that ccache had kept from a
# clone in another folder would be given out in this one, and clang then looks for files that may
# not be there any more. Nor may ccache tell them apart by their bytes, or nothing that uses them is
# found from another folder: NAME.pch.sum, the sum of all that was precompiled, stands for NAME.pch
# (CCACHE_PCH_EXTSUM in scripts/common.sh).
pch='' dependencies='' previous='' is_pch=''
for argument in "$@"; do
  shift
  case $previous in
    -o) pch=$argument ;;
    -MF) dependencies=$argument ;;
  esac
  previous=$argument
  case $argument in
    -emit-pch) is_pch=1 ;;
    # CMake gives clang a path that ccache does not know for one, and so does not make relative. What
    # was precompiled must have the same name.
    "$PWD"/*/cmake_pch.hxx) argument=${argument#"$PWD/"} ;;
  esac
  set -- "$@" "$argument"
done
if [ -z "$is_pch" ]; then exec ccache "$@"; fi

rm -f "$pch.sum"
"$@" || exit
sed '1s/^[^:]*://; s/\\$//' "$dependencies" | xargs sha256sum | cut -d ' ' -f 1 | sha256sum >"$pch.sum"
