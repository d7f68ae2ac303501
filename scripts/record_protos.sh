#!/usr/bin/env bash
# scripts/record_protos.sh : writes proto/released_v1.txtpb, what lightfit.v1 promises from now on.
# Run it with each release, after the tests of proto/ have passed: they compare the schema with the
# record of the release before. proto/README.md has the rule.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../proto"

record=released_v1.txtpb
temporary=$(mktemp "$record.XXXXXX")
trap 'rm -f "$temporary"' EXIT

{
  echo "# proto-file: google/protobuf/descriptor.proto"
  echo "# proto-message: google.protobuf.FileDescriptorSet"
  echo "# Written by scripts/record_protos.sh; see proto/README.md."
  # JSON names follow from the fields' own.
  protoc --descriptor_set_out=/dev/stdout lightfit/v1/*.proto |
    protoc --decode=google.protobuf.FileDescriptorSet google/protobuf/descriptor.proto |
    sed '/^ *json_name: /d'
} >"$temporary"
chmod 644 "$temporary"
mv "$temporary" "$record"
echo "proto/$record: $(grep -c '^file {' "$record") files"
