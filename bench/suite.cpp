// The list of benchmark files, in the order of the stages.
#include "bench.h"

namespace pelage::bench {

Suite all_cases() {
  Suite suite;
  return suite;
}

}  // namespace pelage::bench
