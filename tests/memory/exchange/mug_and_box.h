#pragma once

#include <fstream>

#include "memory/ingest/ingest.h"
#include "tests/memory/store/temporary_folder.h"

namespace loci::memory::testing_support {

/// A memory of a mug (object_1) and a box (object_2) on a table at 8; at 9 the mug is on the shelf, and
/// nobody looks at the box.
class MugAndBox : public TemporaryFolder {
 protected:
  void SetUp() override {
    TemporaryFolder::SetUp();
    const std::string mug = R"("size": [0.08, 0.11, 0.1], "color": [2, 0.85, 0.8])";
    const std::string box = R"("size": [0.2, 0.1, 0.3], "color": [215, 0.8, 0.7])";
    std::ofstream(folder_ / "lines.jsonl")
        << R"({"time": "2026-05-01T08:00:00Z", "observed": [{"place": "table_1"}], "detections": [{"position": [1, 2, 0.8], )"
        << mug << R"(, "place": "table_1"}, {"position": [1.15, 2, 0.9], )" << box
        << R"(, "place": "table_1"}]})"
        << "\n"
        << R"({"time": "2026-05-01T09:00:00Z", "observed": [{"place": "shelf_1"}], "detections": [{"position": [3, 0, 1.2], )"
        << mug << R"(, "place": "shelf_1"}]})"
        << "\n";
    NoProgress silent;
    Warnings warnings;
    IngestOptions options;
    options.noise_m = 0.005;
    ingest(folder_ / "lines.jsonl", file_, options, {}, silent, warnings);
  }
};

}  // namespace loci::memory::testing_support
