#!/bin/sh
# cmake/ccache.sh COMPILER ARGUMENT...: compiles through ccache, in the build folder.
#
# A clone in another folder finds the objects of this one only if nothing on the command line names
# the folder. ccache says paths from the build folder for options that it knows, which CMake's
# `-Xclang -include-pch -Xclang PATH` is not; so paths below it are said that way before.
remaining=$#
while [ "$remaining" -gt 0 ]; do
  argument=$1
  shift
  set -- "$@" "${argument#"$PWD"/}"
  remaining=$((remaining - 1))
done
exec ccache "$@"
