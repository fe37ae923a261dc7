// SPDX-License-Identifier: MIT
#include "kernel/registry/library.h"

#define BOOST_DLL_USE_STD_FS
#include <dlfcn.h>
#include <elf.h>
#include <fmt/format.h>
#include <link.h>

#include <boost/dll/shared_library.hpp>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "kernel/registry/search_path.h"

namespace lapidary {

namespace {

using boost::dll::shared_library;
namespace load_mode = boost::dll::load_mode;

// The loader's own words for what went wrong, without the path that they begin with.
std::string loader_reason(const std::filesystem::path& library) {
    const char* const words = dlerror();
    std::string reason = words ? words : "the dynamic loader gave no reason";
    const std::string path = library.string() + ": ";
    if (reason.starts_with(path)) reason.erase(0, path.size());
    return "the dynamic loader cannot open it: " + reason;
}

// A library that was cut off (a full disk, a copy under way) would be mapped beyond its end and kill the process at the
// first touch. The dynamic loader does not look; all segments being inside the file, and the table of sections, which stands at
// its end, it may.
bool is_cut_off(const std::filesystem::path& library) {
    std::ifstream file(library, std::ios::binary);
    ElfW(Ehdr) header{};
    const auto read = [&file](std::uint64_t offset, auto& structure) {
        file.seekg(static_cast<std::streamoff>(offset));
        return static_cast<bool>(file.read(reinterpret_cast<char*>(&structure), sizeof structure));
    };
    if (!read(0, header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) return false;  // the loader says it better
    std::error_code error;
    const std::uint64_t size = std::filesystem::file_size(library, error);
    const std::uint64_t sections = std::uint64_t{header.e_shnum} * header.e_shentsize;
    if (header.e_shoff > size || sections > size - header.e_shoff) return true;
    for (std::uint64_t i = 0; i < header.e_phnum; ++i) {
        ElfW(Phdr) segment{};
        if (!read(header.e_phoff + i * header.e_phentsize, segment)) return true;
        if (segment.p_type == PT_LOAD && (segment.p_offset > size || segment.p_filesz > size - segment.p_offset)) return true;
    }
    return false;
}

std::filesystem::path module_folder() { return kernel_folder() / "lapidary" / "modules"; }

// The names of the modules that were opened.
class OpenedModules {
public:
    void add(const std::string& name) {
        const std::lock_guard lock(mutex_);
        names_.insert(name);
    }
    bool contains(const std::string& name) const {
        const std::lock_guard lock(mutex_);
        return names_.contains(name);
    }

private:
    mutable std::mutex mutex_;
    std::set<std::string> names_;
};

OpenedModules& opened_modules() {
    static OpenedModules opened;
    return opened;
}

// Never closed, not even at exit, when objects made by a plugin may still be about to be destroyed.
void keep_open(shared_library&& library) {
    static std::mutex mutex;
    static auto& libraries = *new std::vector<shared_library>;
    const std::lock_guard lock(mutex);
    libraries.push_back(std::move(library));
}

}  // namespace

void* open_symbol(const std::filesystem::path& library, const char* symbol) {
    const std::filesystem::path file = std::filesystem::absolute(library);
    if (is_cut_off(file)) throw std::runtime_error("the file is cut off before its end; build or copy it again");
    shared_library opened;
    boost::dll::fs::error_code error;
    opened.load(file, error, load_mode::rtld_now | load_mode::rtld_local);
    if (error) throw std::runtime_error(loader_reason(file));
    if (!opened.has(symbol)) throw std::runtime_error(fmt::format("it exports no '{}'", symbol));
    void* const address = &opened.get<char>(symbol);
    keep_open(std::move(opened));
    return address;
}

void* open_module(const char* name, const char* symbol) {
    const std::filesystem::path file = module_folder() / fmt::format("{}.so", name);
    try {
        void* const address = open_symbol(file, symbol);
        opened_modules().add(name);
        return address;
    } catch (const std::runtime_error& reason) {
        throw std::runtime_error(
            fmt::format("the program's module '{}' cannot be used: {}; the installation is damaged, install it again",
                        file.string(), reason.what()));
    }
}

Modules modules() {
    std::set<std::string> names;
    std::error_code error;  // without the folder there are none
    for (const auto& entry : std::filesystem::directory_iterator(module_folder(), error))
        if (entry.path().extension() == ".so") names.insert(entry.path().stem().string());
    Modules all;
    for (const std::string& name : names) (opened_modules().contains(name) ? all.opened : all.passed_over).push_back(name);
    return all;
}

}  // namespace lapidary
