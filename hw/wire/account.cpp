#include "hw/wire/account.h"

namespace wobblebench::hw {

const char* to_string(LossCause cause) {
  switch (cause) {
    case LossCause::ring_full:
      return "ring_full";
    case LossCause::link:
      return "link";
    case LossCause::corrupt:
      return "corrupt";
    case LossCause::out_of_order:
      return "out_of_order";
  }
  return "unknown";
}

}  // namespace wobblebench::hw
