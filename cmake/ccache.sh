#!/bin/sh
# cmake/ccache.sh COMPILER ARGUMENT...: compiles through ccache, but for clang's precompiled headers.
#
# These name the files that they were made of with their folder. One that ccache had kept from a
# clone in another folder would be given out in this one, and clang then looks for files that may
# not be there any more.
for argument in "$@"; do
  if [ "$argument" = -emit-pch ]; then exec "$@"; fi
done
exec ccache "$@"
