#include "mapping/recording/ros/packed_bag.h"

#include <bzlib.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <random>
#include <vector>

#include "mapping/base/error.h"

namespace loci::mapping {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kMaxUnpacked = uint64_t{64} << 30;
/// Depth and colour images pack to a fifth or so: what grows a thousandfold was made to fill disks.
constexpr uint64_t kMaxRatio = 1000, kMaxSmall = uint64_t{16} << 20;
constexpr size_t kUnpackPiece = size_t{1} << 20;

/// A packing program: the ending that it gives files, and how they begin.
struct Packer {
  const char* ending;
  std::string_view magic;
  const char* unpack;  ///< command
};
constexpr std::array<Packer, 4> kPackers = {{{".zstd", "\x28\xb5\x2f\xfd", "zstd -d"},
                                             {".zst", "\x28\xb5\x2f\xfd", "zstd -d"},
                                             {".gz", "\x1f\x8b", "gunzip -k"},
                                             {".bz2", "BZh", "bunzip2 -k"}}};

const Packer* packer_of(const fs::path& path) {
  const auto found = std::ranges::find(kPackers, path.extension().string(), &Packer::ending);
  return found == kPackers.end() ? nullptr : &*found;
}

class Source {
 public:
  virtual ~Source() = default;
  /// Unpacks into a buffer: how many bytes came, 0 at the end. Error where the packed bytes are damaged.
  virtual size_t read(char* bytes, size_t size) = 0;
  /// Packed bytes that were read.
  virtual int64_t position() = 0;
};

Error damaged_stream() {
  return Error("damaged or truncated");
}

/// Any number of zstd frames one after the other.
class ZstdSource : public Source {
 public:
  explicit ZstdSource(const fs::path& path)
      : file_(path, std::ios::binary),
        stream_(ZSTD_createDStream(), ZSTD_freeDStream),
        packed_(kUnpackPiece) {
    ZSTD_DCtx_setParameter(stream_.get(), ZSTD_d_windowLogMax, 27);  // At most 128 MB for the window.
  }
  size_t read(char* bytes, size_t size) override {
    ZSTD_outBuffer out{bytes, size, 0};
    while (out.pos == 0) {
      if (in_.pos == in_.size) {
        file_.read(packed_.data(), static_cast<std::streamsize>(packed_.size()));
        in_ = {packed_.data(), static_cast<size_t>(file_.gcount()), 0};
        position_ += file_.gcount();
        if (in_.size == 0 && left_ == 0) return 0;
      }
      const bool at_end = in_.size == 0;
      left_ = ZSTD_decompressStream(stream_.get(), &out, &in_);
      if (ZSTD_isError(left_) != 0) throw Error(ZSTD_getErrorName(left_));
      if (at_end && out.pos == 0) throw damaged_stream();
    }
    return out.pos;
  }
  int64_t position() override { return position_; }

 private:
  std::ifstream file_;
  std::unique_ptr<ZSTD_DStream, size_t (*)(ZSTD_DStream*)> stream_;
  std::vector<char> packed_;
  ZSTD_inBuffer in_{nullptr, 0, 0};
  int64_t position_ = 0;
  size_t left_ = 1;  ///< 0 = a frame is complete
};

class GzipSource : public Source {
 public:
  explicit GzipSource(const fs::path& path) : file_(gzopen(path.c_str(), "rb"), gzclose) {}
  size_t read(char* bytes, size_t size) override {
    const int count = gzread(file_.get(), bytes, static_cast<unsigned>(size));
    int error = Z_OK;
    gzerror(file_.get(), &error);
    if (count < 0 || (count == 0 && error != Z_OK)) throw damaged_stream();
    return static_cast<size_t>(count);
  }
  int64_t position() override { return gzoffset(file_.get()); }

 private:
  std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
};

/// Any number of streams one after the other, as programs for several cores write them.
class Bzip2Source : public Source {
 public:
  explicit Bzip2Source(const fs::path& path) : file_(std::fopen(path.c_str(), "rb"), std::fclose) { open(); }
  ~Bzip2Source() override { close(); }
  Bzip2Source(const Bzip2Source&) = delete;
  Bzip2Source& operator=(const Bzip2Source&) = delete;

  size_t read(char* bytes, size_t size) override {
    while (stream_ != nullptr) {
      int status = BZ_OK;
      const int count = BZ2_bzRead(&status, stream_, bytes, static_cast<int>(size));
      if (status != BZ_OK && status != BZ_STREAM_END) throw damaged_stream();
      if (status == BZ_STREAM_END) open_next();
      if (count > 0) return static_cast<size_t>(count);
    }
    return 0;
  }
  int64_t position() override { return std::ftell(file_.get()); }

 private:
  void open() {
    int status = BZ_OK;
    stream_ = BZ2_bzReadOpen(&status, file_.get(), 0, 0, rest_.data(), static_cast<int>(rest_.size()));
    if (status != BZ_OK) throw damaged_stream();
  }
  void open_next() {
    int status = BZ_OK, count = 0;
    void* unused = nullptr;
    BZ2_bzReadGetUnused(&status, stream_, &unused, &count);
    rest_.assign(static_cast<const char*>(unused), static_cast<size_t>(count));
    close();
    const int next = rest_.empty() ? std::fgetc(file_.get()) : EOF;
    if (next != EOF) rest_.push_back(static_cast<char>(next));
    if (!rest_.empty()) open();
  }
  void close() {
    int status = BZ_OK;
    if (stream_ != nullptr) BZ2_bzReadClose(&status, stream_);
    stream_ = nullptr;
  }

  std::unique_ptr<FILE, int (*)(FILE*)> file_;
  std::string rest_;  ///< of the packed bytes, behind the stream before
  BZFILE* stream_ = nullptr;
};

std::unique_ptr<Source> source_of(const fs::path& path) {
  const std::string ending = path.extension().string();
  if (ending == ".gz") return std::make_unique<GzipSource>(path);
  if (ending == ".bz2") return std::make_unique<Bzip2Source>(path);
  return std::make_unique<ZstdSource>(path);
}

Error no_room(const fs::path& packed, const fs::path& folder, const std::string& why) {
  return Error(fmt::format("the bag cannot be unpacked into {}: {}", folder.string(), why),
               {packed.string(), 0, {}},
               fmt::format("name a folder with room in TMPDIR, or unpack it: {} {}",
                           packer_of(packed)->unpack, packed.string()));
}

}  // namespace

bool is_packed_bag(const fs::path& path) {
  const Packer* packer = packer_of(path);
  const std::string inner = path.stem().extension().string();
  if (packer == nullptr || (inner != ".mcap" && inner != ".db3" && inner != ".bag")) return false;
  if (!fs::is_regular_file(path)) return false;
  std::ifstream file(path, std::ios::binary);
  std::string head(packer->magic.size(), '\0');
  return file.read(head.data(), static_cast<std::streamsize>(head.size())) && head == packer->magic;
}

UnpackedBag::UnpackedBag(const fs::path& packed, Progress& progress) {
  std::error_code code;
  const fs::path folder = fs::temp_directory_path(code);
  if (code) throw no_room(packed, "the temporary folder", code.message());
  try {
    create(folder);
    unpack(packed, folder, progress);
    if (path_.empty()) give_name(folder);
  } catch (...) {
    remove();
    throw;
  }
}

UnpackedBag::~UnpackedBag() {
  remove();
}

void UnpackedBag::create(const fs::path& folder) {
  file_ = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
  if (file_ >= 0) return;
  std::string name = (folder / "loci_bag_XXXXXX").string();
  file_ = ::mkostemp(name.data(), O_CLOEXEC);
  if (file_ < 0)
    throw Error(fmt::format("no file can be made: {}", std::strerror(errno)), {folder.string(), 0, {}});
  path_ = name;
}

void UnpackedBag::unpack(const fs::path& packed, const fs::path& folder, Progress& progress) {
  const uint64_t packed_size = fs::file_size(packed);
  const uint64_t max = std::min(kMaxUnpacked, kMaxSmall + kMaxRatio * packed_size);
  uint64_t size = 0;
  std::vector<char> piece(kUnpackPiece);
  const std::unique_ptr<Source> source = source_of(packed);
  while (true) {
    progress.check(std::min(1.0, static_cast<double>(source->position()) / static_cast<double>(packed_size)),
                   fmt::format("unpacking {}", packed.filename().string()));
    size_t count = 0;
    try {
      count = source->read(piece.data(), piece.size());
    } catch (const Error& error) {
      if (size == 0)
        throw Error(fmt::format("the bag cannot be unpacked: {}", error.message()), {packed.string(), 0, {}});
      problem_ = fmt::format("{}: {} behind {} unpacked bytes; what stands before that is used",
                             packed.string(), error.message(), size);
      return;
    }
    if (count == 0) return;
    size += count;
    if (size > max)
      throw Error(
          fmt::format("the bag unpacks to more than {} bytes, as many as are allowed for its size", max),
          {packed.string(), 0, {}},
          fmt::format("if that is right, unpack it: {} {}", packer_of(packed)->unpack, packed.string()));
    for (size_t done = 0; done < count;) {
      const ssize_t written = ::write(file_, piece.data() + done, count - done);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) throw no_room(packed, folder, std::strerror(errno));
      done += static_cast<size_t>(written);
    }
  }
}

void UnpackedBag::give_name(const fs::path& folder) {
  std::random_device random;
  const fs::path name = folder / fmt::format("loci_bag_{:08x}{:08x}", random(), random());
  if (::linkat(AT_FDCWD, fmt::format("/proc/self/fd/{}", file_).c_str(), AT_FDCWD, name.c_str(),
               AT_SYMLINK_FOLLOW) != 0)
    throw Error(fmt::format("no file can be made: {}", std::strerror(errno)), {name.string(), 0, {}});
  path_ = name;
}

void UnpackedBag::remove() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
  if (!path_.empty()) ::unlink(path_.c_str());
  path_.clear();
}

}  // namespace loci::mapping
