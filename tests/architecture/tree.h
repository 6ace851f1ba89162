#pragma once

#include <array>
#include <cstdio>
#include <filesystem>
#include <string>

/// The repository.
inline const std::filesystem::path kRoot = LOCI_SOURCE_DIR;

/// What a shell command prints on standard output.
inline std::string output_of(const std::string& command) {
  std::string text;
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  std::array<char, 4096> buffer = {};
  while (const size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    text.append(buffer.data(), count);
  pclose(pipe);
  return text;
}
