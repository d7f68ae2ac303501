// tests/cli/examples.h
//
// The read-backs that the tests run on, and how to read what the program wrote.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/testing/process.h"
#include "wire/result_json.h"

namespace lightfit {

inline const std::string kYard = RepositoryPath("examples/yard_180/0001.exr");
inline const std::string kYardLights = RepositoryPath("examples/yard_180/scene.json");
inline const std::string kRoom = RepositoryPath("examples/room_180/0001.exr");
inline const std::string kRoomLights = RepositoryPath("examples/room_180/scene.json");

inline v1::FitResult ReadResult(const std::string& path) {
  const absl::StatusOr<v1::FitResult> result = ReadFitResultJson(path);
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *result : v1::FitResult();
}

inline Eigen::Matrix4d MatrixOf(const v1::Matrix4x4& proto) {
  const absl::StatusOr<Eigen::Matrix4d> matrix = MatrixFromProto(proto, "matrix");
  EXPECT_TRUE(matrix.ok()) << matrix.status();
  return matrix.ok() ? *matrix : Eigen::Matrix4d::Zero();
}

}  // namespace lightfit
