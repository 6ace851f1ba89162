#pragma once

#include <cstdio>
#include <filesystem>
#include <string_view>
#include <vector>

namespace loci {

/// What may happen to a file that is at the path of an output.
enum class Replace {
  nothing,   ///< the path must be free
  own,       ///< it may be replaced if loci wrote it and nobody changed it since (written_by_loci)
  anything,  ///< it may be replaced: the user said --force, or it lies in a folder that loci made
};

struct OutputOptions {
  Replace replace = Replace::own;
  /// Files and folders that the same command reads. They are never replaced, under whatever name.
  std::vector<std::filesystem::path> inputs = {};
  unsigned mode = 0666;  ///< permissions of a new file, less the umask; 0600 for memories
};

/// Whether loci wrote the file as it is now. OutputFile marks what it writes with an extended attribute that
/// holds the time of the last change: a file that was edited since counts as written by somebody else, and so
/// does a copy without its attributes. On file systems without extended attributes a file counts as written
/// by loci if its first 4 KiB name loci. Never true for a memory: no other output replaces one.
bool written_by_loci(const std::filesystem::path& file);

/// Throws Error when `output` is one of `inputs`, or a folder that contains one of them. Paths are compared
/// after resolving symbolic links, and by device and inode.
void refuse_inputs(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs);

/// A recording that loci wrote names its files in this one, a line each.
inline constexpr const char* kRecordingManifest = ".loci-recording";

/// Throws Error when `output` lies within one of the folders, or within a recording that loci wrote: its
/// files belong together, and nothing is added to them.
void refuse_within(const std::filesystem::path& output, const std::vector<std::filesystem::path>& recordings);

/// Throws Error when OutputFile would refuse to write `path`. For commands that find out late what they
/// write.
void check_output(const std::filesystem::path& path, const OutputOptions& options);

/// Removes the temporary files of an output whose programs were killed; their paths. Those of programs that
/// run, here or on other machines, stay.
std::vector<std::filesystem::path> remove_abandoned(const std::filesystem::path& path);

/// A file that a program writes. It is written under a temporary name in the same folder, and takes its name
/// at commit(), synchronised with the disk. Without commit() the temporary file is removed, and what was
/// there before stays. A symbolic link stays, and the file that it points to is replaced.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path path, OutputOptions options = {});
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// The temporary file, empty at first, for libraries that write by name.
  const std::filesystem::path& temporary() const { return temporary_; }
  void write(std::string_view bytes);
  void commit();

 private:
  void discard();

  std::filesystem::path path_;    ///< as given, for messages
  std::filesystem::path target_;  ///< links resolved
  std::filesystem::path temporary_;
  OutputOptions options_;
  std::FILE* file_ = nullptr;
};

/// Writes a whole file through OutputFile.
void write_output(const std::filesystem::path& path, std::string_view bytes,
                  const OutputOptions& options = {});

}  // namespace loci
