// Points as text.
#include "retalho/cloud/formats.h"

#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace retalho;
  return fuzz::refuse_or([&] {
    PointCloud cloud;
    PointNotes notes;
    parse_text_points(std::string(fuzz::text_of(data, size)), "fuzz.xyz", cloud, notes);
    fuzz::require(cloud.normals.empty() || cloud.normals.size() == cloud.positions.size(), "normals of some points");
    fuzz::require(cloud.positions.size() <= size, "more points than bytes");
  });
}
