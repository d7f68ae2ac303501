#include "wire/crawl_proto.h"

namespace lightfit {

v1::Crawl CrawlToProto(const Crawl& crawl) {
  v1::Crawl proto;
  proto.set_num_points(crawl.num_points);
  proto.set_phase_drift_texels(crawl.phase_drift_texels);
  proto.set_moved_share(crawl.moved_share);
  proto.set_num_edge_points(crawl.num_edge_points);
  proto.set_edge_crawl_px(crawl.edge_crawl_px);
  return proto;
}

Crawl CrawlFromProto(const v1::Crawl& proto) {
  return {proto.num_points(),
          proto.phase_drift_texels(),
          proto.moved_share(),
          proto.num_edge_points(),
          proto.edge_crawl_px()};
}

}  // namespace lightfit
