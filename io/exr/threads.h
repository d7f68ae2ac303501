// io/exr/threads.h
//
// Threads in which OpenEXR compresses and decompresses; internal to io/.
// In:   nothing.
// Out:  as many threads as there are processors, up to 8, shared by all files.
#pragma once

namespace lightfit::internal {

// OpenEXR has none until told. To be called before a file is opened; does nothing after the first
// time.
void StartExrThreads();

}  // namespace lightfit::internal
