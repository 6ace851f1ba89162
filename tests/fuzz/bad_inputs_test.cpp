#include "tests/fuzz/bad_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "mapping/base/files.h"
#include "tests/fuzz/targets.h"

namespace loci::fuzz {
namespace {

namespace fs = std::filesystem;

std::string repeated(const std::string& text, int count) {
  std::string result;
  for (int i = 0; i < count; ++i) result += text;
  return result;
}

/// Where the n-th number of a text begins and ends.
std::pair<size_t, size_t> number_in(const std::string& text, size_t n) {
  size_t begin = 0, end = 0;
  for (size_t i = 0; i <= n; ++i) {
    begin = text.find_first_of("0123456789", end);
    if (begin == std::string::npos) return {0, 0};
    end = std::min(text.find_first_not_of("0123456789.eE+-", begin), text.size());
  }
  return {begin, end};
}

/// A NumPy array that has this head and no numbers.
std::string npy(const std::string& head) {
  const std::array<char, 2> length = {static_cast<char>(head.size() & 255),
                                      static_cast<char>(head.size() >> 8)};
  return std::string("\x93NUMPY\x01\0", 8) + std::string(length.data(), 2) + head;
}

/// The same mistakes for any file.
std::vector<std::pair<std::string, std::string>> mistakes(const std::string& seed) {
  std::vector<std::pair<std::string, std::string>> made;
  const size_t size = seed.size(), part = size / 8 + 1;
  for (size_t i = 0; i < 8; ++i) {
    const size_t at = std::min(i * size / 8, size);
    made.emplace_back(fmt::format("cut at {}/8", i), seed.substr(0, at));
    made.emplace_back(fmt::format("part {}/8 removed", i),
                      seed.substr(0, at) + seed.substr(std::min(at + part, size)));
    made.emplace_back(fmt::format("part {}/8 twice", i),
                      seed.substr(0, at) + seed.substr(at, part) + seed.substr(at));
  }
  made.emplace_back("halves exchanged", seed.substr(size / 2) + seed.substr(0, size / 2));
  made.emplace_back("twice", seed + seed);
  made.emplace_back("bytes reversed", std::string(seed.rbegin(), seed.rend()));
  made.emplace_back("byte order mark", "\xef\xbb\xbf" + seed);
  made.emplace_back("NUL at the end", seed + std::string(1, '\0'));
  for (size_t i = 1; i < 4; ++i)
    for (const int byte : {0x00, 0xff, 0x1b}) {
      std::string changed = seed;
      changed[i * size / 4 % std::max<size_t>(size, 1)] = static_cast<char>(byte);
      made.emplace_back(fmt::format("byte {}/4 is {:#04x}", i, byte), changed);
    }
  for (const size_t n : {0, 3, 7, 12})
    for (const char* number :
         {"nan", "-1", "1e999", "99999999999999999999", "4294967296", "", "0x10", "\"7\""}) {
      const auto [begin, end] = number_in(seed, n);
      if (end == 0) continue;
      made.emplace_back(fmt::format("number {} is '{}'", n, number),
                        seed.substr(0, begin) + number + seed.substr(end));
    }
  return made;
}

/// What readers of a kind are known to trip over.
struct ByHand {
  const char* target;
  const char* name;
  std::string bytes;
};

std::vector<ByHand> by_hand() {
  const std::string robot = "<robot name=\"r\">";
  const std::string deep_json = repeated("[", 200000) + repeated("]", 200000);
  const std::string deep_object = repeated("{\"a\":", 100000) + "1" + repeated("}", 100000);
  std::vector<ByHand> table = {
      {"urdf", "entity bomb",
       "<!DOCTYPE r [<!ENTITY a \"aaaa\"><!ENTITY b \"&a;&a;&a;\">]><robot name=\"&b;\"><link "
       "name=\"a\"/></robot>"},
      {"urdf", "external entity",
       "<!DOCTYPE r [<!ENTITY a SYSTEM \"file:///etc/passwd\">]><robot name=\"&a;\"><link "
       "name=\"a\"/></robot>"},
      {"urdf", "deep", robot + repeated("<a>", 100000) + repeated("</a>", 100000) + "</robot>"},
      {"urdf", "many links", robot + repeated("<link name=\"a\"/>", 10000) + "</robot>"},
      {"urdf", "mesh that is a device",
       robot + "<link name=\"a\"><visual><geometry><mesh "
               "filename=\"/dev/zero\"/></geometry></visual></link></robot>"},
      {"urdf", "subnormal box",
       robot + "<link name=\"a\"><visual><geometry><box size=\"5e-324 1 "
               "1\"/></geometry></visual></link></robot>"},
      {"urdf", "names with control characters", robot + "<link name=\"&#27;[2J\"/></robot>"},
      {"urdf", "utf-16", std::string("\xff\xfe<\0r\0", 6)},
      {"sidecar", "deep", deep_json},
      {"sidecar", "deep links", "{\"version\":1,\"links\":" + deep_object + "}"},
      {"sidecar", "links is a list", "{\"version\": 1, \"frame\": \"map\", \"links\": []}"},
      {"sidecar", "geometry is a text",
       "{\"version\": 1, \"frame\": \"map\", \"links\": {\"a\": {\"class\": \"wall\", \"geometry\": "
       "\"x\"}}}"},
      {"sidecar", "version of the future", "{\"version\": 99, \"frame\": \"map\", \"links\": {}}"},
      {"canonical_json", "deep", deep_json},
      {"canonical_json", "deep structures", "{\"structures\":" + deep_object + "}"},
      {"canonical_json", "array of nothing",
       "{\"root\":\"#1\",\"structures\":[{\"id\":1,\"type\":\"uima.cas.FSArray\",\"elements\":null}]}"},
      {"canonical_json", "loop",
       "{\"root\":\"#1\",\"structures\":[{\"id\":1,\"type\":\"uima.cas.FSArray\",\"elements\":[\"#1\"]}]}"},
      {"canonical_json", "unknown type",
       "{\"root\":\"#1\",\"structures\":[{\"id\":1,\"type\":\"x.Y\",\"features\":{}}]}"},
      {"canonical_json", "bad base64",
       "{\"root\":\"#1\",\"structures\":[{\"id\":1,\"type\":\"uima.cas.FloatArray\",\"elements\":{\"base64\":"
       "\"AAA\"}}]}"},
      {"canonical_json", "blob from nowhere",
       "{\"root\":\"#1\",\"structures\":[{\"id\":1,\"type\":\"uima.cas.FloatArray\",\"elements\":{\"blob\":"
       "\"0\"}}]}"},
      {"catalogue", "deep", deep_json},
      {"catalogue", "deep object", deep_object},
      {"catalogue", "a number", "1e999"},
      {"identity", "deep", deep_json},
      {"identity", "huge shape", "{\"objects\": 4000000000, \"observations\": 4000000000}"},
      {"detections", "deep", "{\"time\": \"2026-05-01T08:30:00Z\", \"detections\": " + deep_json + "}"},
      {"detections", "position of two",
       "{\"time\": \"2026-05-01T08:30:00Z\", \"detections\": [{\"position\": [1, 2]}]}"},
      {"detections", "overflowing position",
       "{\"time\": \"2026-05-01T08:30:00Z\", \"detections\": [{\"position\": [1e308, 1e308, 1e308], "
       "\"size\": [1e308, 1e308, 1e308]}]}"},
      {"detections", "feature too large for a float",
       "{\"time\": \"2026-05-01T08:30:00Z\", \"detections\": [{\"position\": [1, 2, 3], \"features\": "
       "{\"f\": [1e300]}}]}"},
      {"detections", "time of the year 9999", "{\"time\": \"9999-12-31T23:59:59Z\", \"detections\": []}"},
      {"detections", "camera of no pixels",
       "{\"time\": \"2026-05-01T08:30:00Z\", \"camera\": {\"pose\": [0,0,0,0,0,0,0], \"width\": 0, "
       "\"height\": 0, \"fx\": 0, \"fy\": 0, \"cx\": 0, \"cy\": 0}, \"detections\": []}"},
      {"scenario", "alias bomb", "a: &a [x, x, x]\nb: &b [*a, *a, *a]\nscenes: [*b, *b]\n"},
      {"scenario", "alias of itself", "world: &a [*a]\nscenes: []\n"},
      {"scenario", "deep", "world: " + repeated("[", 100000)},
      {"scenario", "key that is a list", "? [a, b]\n: c\n"},
      {"scenario", "two documents", "world: a.urdf\n---\nworld: b.urdf\n"},
      {"scenario", "tag", "world: !!binary aGVsbG8=\nscenes: !!python/object:os.system x\n"},
      {"scenario", "tab", "world:\n\t- x\n"},
      {"pipeline", "deep", "flow: " + repeated("[", 100000)},
      {"pipeline", "alias bomb", "flow: &a [*a]\n"},
      {"pipeline", "deep condition",
       "flow:\n  - if: \"" + repeated("(", 100000) + "Cluster" + repeated(")", 100000) +
           "\"\n    then: [Speaker]\n"},
      {"pipeline", "step of two keys", "flow:\n  - {Speaker: {}, Listener: {}}\n"},
      {"pipeline", "empty step", "flow:\n  - {}\n"},
      {"pipeline", "flow is a text", "flow: Speaker\n"},
      {"pipeline", "null step", "flow: [~]\n"},
      {"condition", "deep", repeated("(", 100000) + "Cluster" + repeated(")", 100000)},
      {"condition", "nots", repeated("not ", 100000) + "Cluster"},
      {"condition", "long", repeated("Cluster or ", 10000) + "Cluster"},
      {"condition", "dots", "......"},
      {"condition", "lone comparison", "> 3"},
      {"condition", "number overflow", "GeometryAnnotation.height > 1e999"},
      {"goal", "only equals", "==== ="},
      {"goal", "format", "color={}{} text={0}"},
      {"question", "long ago", "100000 weeks ago"},
      {"question", "longer ago", "9223372036854775807 weeks ago"},
      {"question", "half past", "half past"},
      {"question", "25 o'clock", "25 o'clock"},
      {"question", "quotes", "where \"cup"},
      {"question", "escape", "where \x1b[2J cup"},
      {"question", "long word", "where " + std::string(1 << 20, 'x')},
      {"question", "many words", repeated("where was the ", 10000)},
      {"scans", "deep", "scans: " + repeated("[", 100000)},
      {"scans", "file elsewhere", "version: 1\nscans:\n  - {file: ../../../../../../etc/passwd}\n"},
      {"pcd", "huge",
       "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4294967295\nHEIGHT "
       "4294967295\nDATA binary\n"},
      {"pcd", "huge count",
       "VERSION 0.7\nFIELDS x\nSIZE 4\nTYPE F\nCOUNT 2147483647\nWIDTH 1\nHEIGHT 1\nDATA binary\n"},
      {"pcd", "negative",
       "VERSION 0.7\nFIELDS x y z\nSIZE -4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH -1\nHEIGHT 1\nDATA ascii\n"},
      {"pcd", "no size",
       "VERSION 0.7\nFIELDS x y z\nSIZE 0 0 0\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1000000000\nHEIGHT 1\nDATA "
       "binary\n"},
      {"pcd", "compressed bomb",
       "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 100000000\nHEIGHT 1\nDATA "
       "binary_compressed\n" +
           std::string("\x01\0\0\0\xff\xff\xff\x7f", 8)},
      {"bag", "version alone", "#ROSBAG V2.0\n"},
      {"bag", "huge header", "#ROSBAG V2.0\n" + std::string("\xff\xff\xff\x7f", 4)},
      {"bag", "zstd of nothing", std::string("\x28\xb5\x2f\xfd", 4)},
      {"bag", "zstd with a window of 2 GB",
       std::string("\x28\xb5\x2f\xfd\x00\xa8", 6) + std::string(100, 'x')},
      {"bag", "gzip of nothing", std::string("\x1f\x8b\x08\0\0\0\0\0\0\x03", 10)},
      {"bag", "bzip2 of nothing", "BZh9\x17\x72\x45\x38\x50\x90"},
      {"depth", "npy of 4 G x 4 G",
       npy("{'descr': '<f4', 'fortran_order': False, 'shape': (4294967296, 4294967296), }")},
      {"depth", "npy whose size overflows",
       npy("{'descr': '<f8', 'fortran_order': False, 'shape': (4611686018427387904, 2), }")},
      {"depth", "npy of many dimensions",
       npy("{'descr': '<f4', 'fortran_order': False, 'shape': (" + repeated("1,", 1000) + "), }")},
      {"depth", "npy of code", npy("__import__('os').system('true')")},
      {"depth", "npy with a key twice",
       npy("{'descr': '<f4', 'descr': '<f4', 'fortran_order': False, 'shape': (1, 1), }")},
      {"depth", "npy of an open text", npy("{'descr': '<f4")},
      {"depth", "npy with a head of 4 GB", std::string("\x93NUMPY\x02\0\xff\xff\xff\xff", 12)},
      {"depth", "npy of the future", std::string("\x93NUMPY\x09\0\x01\0{}", 12)},
      {"depth", "tiff of nothing", std::string("II*\0\x08\0\0\0\0\0", 10)},
      {"depth", "tiff whose directory is its head", std::string("II*\0\0\0\0\0", 8)},
      {"depth", "tiff with 65535 tags", std::string("II*\0\x08\0\0\0\xff\xff", 10) + std::string(1000, '\1')},
      {"depth", "exr of nothing", std::string("\x76\x2f\x31\x01\x02\0\0\0\0", 9)},
      {"depth", "exr with an attribute of 2 GB",
       std::string("\x76\x2f\x31\x01\x02\0\0\0a\0string\0\xff\xff\xff\x7f", 21)},
      {"recording", "no separator", "version: 1\n"},
      {"recording", "alias", "version: &a [*a]\n---\nindex\n"},
      {"rvl", "huge", std::string("\xff\xff\xff\xff\xff\xff\xff\xff", 8)},
      {"rvl", "no pixels", std::string(12, '\0')},
      {"rvl", "a run beyond", std::string("\x02\0\0\0\x02\0\0\0\0\0\x00\x7f", 12)},
      {"rvl", "an endless number", std::string("\x02\0\0\0\x02\0\0\0", 8) + std::string(64, '\xff')},
      {"rvl", "runs of nothing", std::string("\x02\0\0\0\x02\0\0\0", 8) + std::string(1 << 20, '\0')},
      {"rvl", "a value below nothing", std::string("\x02\0\0\0\x02\0\0\0\0\0\x10\x04", 12)},
      {"image", "png bomb",
       std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\x7f\xff\xff\xff\x7f\xff\xff\xff\x10\x06\0\0\0\0\0\0\0",
                   33)},
      {"image", "jpeg of markers", "\xff\xd8" + repeated("\xff\xe0" + std::string("\0\x02", 2), 20000)},
      {"image", "gif", "GIF89a\x01"},
      {"search_request", "group", repeated("\x0b", 100000)},
      {"search_request", "huge length", "\x0a\xff\xff\xff\xff\x0f"},
      {"search_response", "group", repeated("\x0b", 100000)},
      {"search_response", "long varint", std::string(20, '\xff')},
      {"products", "image elsewhere", "name,image\nx,/etc/passwd\n"},
      {"products", "quote", "name,image\n\"x,a.jpg\n"},
      {"type_system", "imports itself",
       "<typeSystemDescription><imports><import location=\"input.xml\"/></imports></typeSystemDescription>"},
      {"type_system", "imports a device",
       "<typeSystemDescription><imports><import location=\"/dev/zero\"/></imports></typeSystemDescription>"},
      {"type_system", "deep", "<typeSystemDescription>" + repeated("<a>", 100000)},
      {"type_system", "inherits from itself",
       "<typeSystemDescription><types><typeDescription><name>a.B</name><supertypeName>a.B</supertypeName></"
       "typeDescription></types></typeSystemDescription>"},
      {"xmi", "deep", "<xmi:XMI xmlns:xmi=\"http://www.omg.org/XMI\">" + repeated("<a>", 100000)},
      {"xmi", "loop",
       "<xmi:XMI xmlns:xmi=\"http://www.omg.org/XMI\" xmlns:cas=\"http:///uima/cas.ecore\"><cas:FSArray "
       "xmi:id=\"1\" elements=\"1 1\"/></xmi:XMI>"},
      {"xmi", "prefix that is not declared",
       "<xmi:XMI xmlns:xmi=\"http://www.omg.org/XMI\"><cas:FSArray xmi:id=\"1\"/></xmi:XMI>"},
      {"memory_rows", "all zeros", std::string(4000, '\0')},
      {"memory_rows", "all ones", std::string(4000, '\xff')},
      {"terminal", "not UTF-8", "\xc3(\xe2\x82(\xf0\x9f\x98"},
  };
  std::string types = "<typeSystemDescription><types>";
  for (int i = 0; i < 20000; ++i)
    types += fmt::format(
        "<typeDescription><name>a.T{:06}</name><supertypeName>{}</supertypeName></typeDescription>", i,
        i == 0 ? "uima.cas.TOP" : fmt::format("a.T{:06}", i - 1));
  table.push_back({"type_system", "a long line of ancestors", types + "</types></typeSystemDescription>"});
  for (const Target& target : targets()) {
    table.push_back({target.name, "empty", ""});
    table.push_back({target.name, "a blank", " "});
    table.push_back({target.name, "a NUL", std::string(1, '\0')});
    table.push_back({target.name, "a million x", repeated("x", 1'000'000)});
  }
  return table;
}

}  // namespace

std::vector<BadInput> bad_inputs(const fs::path& seeds) {
  std::vector<BadInput> table;
  for (const Target& target : targets()) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(seeds / target.name))
      if (entry.path().filename().string().starts_with("seed")) files.push_back(entry.path());
    std::ranges::sort(files);
    for (const fs::path& file : files)
      for (auto& [name, bytes] : mistakes(read_file(file)))
        table.push_back({target.name, file.filename().string() + ": " + name, std::move(bytes)});
  }
  for (ByHand& each : by_hand()) table.push_back({each.target, each.name, std::move(each.bytes)});
  return table;
}

}  // namespace loci::fuzz
