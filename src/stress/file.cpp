#include "stress/file.h"

#include <fstream>

#include "base/error.h"

namespace kadr::stress {

void write_file(const std::filesystem::path& file, std::string_view text) {
    std::ofstream stream(file, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) throw RenderError("cannot write " + file.string());
}

void write_file(const std::filesystem::path& file, std::span<const unsigned char> bytes) {
    write_file(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace kadr::stress
