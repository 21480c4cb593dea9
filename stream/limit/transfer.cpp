#include "stream/limit/transfer.h"

#include <fstream>
#include <string>

namespace pss {

Transfer transferred() {
  Transfer transfer;
  std::ifstream counters("/proc/self/io");
  std::uint64_t value = 0;
  for (std::string name; counters >> name >> value;) {
    if (name == "rchar:") transfer.read = value;
    if (name == "wchar:") transfer.written = value;
  }
  return transfer;
}

Transfer transferred_since(const Transfer& before) {
  const Transfer now = transferred();
  return {now.read - before.read, now.written - before.written};
}

}  // namespace pss
