// The list of benchmark files, in the order of the stages.
#include "bench.h"

namespace pelage::bench {

void add_io_cases(Suite& suite);
void add_lod_cases(Suite& suite);
void add_simulate_cases(Suite& suite);
void add_assemble_cases(Suite& suite);
void add_raster_cases(Suite& suite);
void add_light_cases(Suite& suite);
void add_shade_cases(Suite& suite);
void add_aggregate_cases(Suite& suite);
void add_metrics_cases(Suite& suite);
void add_filter_cases(Suite& suite);
void add_link_cases(Suite& suite);
#if PELAGE_HAIRMESH
void add_swr_cases(Suite& suite);
#endif
void add_frame_cases(Suite& suite);
void add_reference_cases(Suite& suite);

Suite all_cases() {
  Suite suite;
  add_io_cases(suite);
  add_lod_cases(suite);
  add_simulate_cases(suite);
  add_assemble_cases(suite);
  add_raster_cases(suite);
  add_light_cases(suite);
  add_shade_cases(suite);
  add_aggregate_cases(suite);
  add_metrics_cases(suite);
  add_filter_cases(suite);
  add_link_cases(suite);
#if PELAGE_HAIRMESH
  add_swr_cases(suite);
#endif
  add_frame_cases(suite);
  add_reference_cases(suite);
  return suite;
}

}  // namespace pelage::bench
