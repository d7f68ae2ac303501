// io/notes/readback_notes.h
//
// What is to be said of the read-backs that a job reads: once, where many are alike.
// In:   each read-back's origin and warnings.
// Out:  lines: what was taken of the files, and what may be wrong with them.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "io/readback_exr.h"
#include "lightfit/v1/result.pb.h"

namespace lightfit {

class ReadbackNotes {
 public:
  // `place` is the file's among the others, and decides which of them is named first.
  void Add(size_t place, const std::string& path, const ReadbackFile& file);

  // depth "Z", ..., and how many files differ from the first; empty without any.
  std::string OriginText() const;

  // One for each kind of warning, with the first file that has it and how many others do.
  std::vector<std::string> Warnings() const;

 private:
  struct Note {
    std::string path, origin;
    std::vector<ReadbackWarning> warnings;
  };
  std::map<size_t, Note> notes_;  // by place
};

// In results: origin, background and warnings of one.
void PutNotes(const ReadbackFile& file, v1::ReadbackInfo* info);

}  // namespace lightfit
