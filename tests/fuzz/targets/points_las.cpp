// Points as LAS.
#include "retalho/cloud/formats.h"

#include "target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace retalho;
  return fuzz::refuse_or([&] {
    PointCloud cloud;
    PointNotes notes;
    std::string crs;
    parse_las_points(std::string(fuzz::text_of(data, size)), "fuzz.las", cloud, notes, crs);
    fuzz::require(cloud.positions.size() <= size, "more points than bytes");
    fuzz::require(crs.size() <= size + 16, "a coordinate system that the file does not hold");
  });
}
