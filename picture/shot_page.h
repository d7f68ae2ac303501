// picture/shot_page.h
//
// The picture of a shot: energy, footprint and crawl over its frames, in every mode.
// In:   ShotRows.
// Out:  a Canvas, ready for WritePng().
//
// One column per light, up to four side by side, and below each other three charts: the energy as a
// multiple of the frame's own best, the RMS footprint, and how far shadow edges crawl. Dots mark
// the frames in which a tracked map moved over surfaces.
#pragma once

#include "jobs/shot/result.h"
#include "picture/canvas.h"
#include "picture/text.h"

namespace lightfit {

Canvas DrawShotPlot(const ShotJob& job, const ShotRows& rows, const Typeface& typeface);

}  // namespace lightfit
