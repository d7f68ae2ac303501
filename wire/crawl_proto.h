// wire/crawl_proto.h
//
// Crawl to and from lightfit.v1. Flips are the caller's to add.
#pragma once

#include "lightfit/v1/crawl.pb.h"
#include "optimizer/figures/stability.h"

namespace lightfit {

v1::Crawl CrawlToProto(const Crawl& crawl);
Crawl CrawlFromProto(const v1::Crawl& proto);

}  // namespace lightfit
