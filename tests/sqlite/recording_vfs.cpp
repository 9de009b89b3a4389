// SPDX-License-Identifier: MIT
#include "sqlite/recording_vfs.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <random>
#include <utility>

namespace seqloop::test {
namespace {

using What = FileEvent::What;

RecordingVfs* active = nullptr;
sqlite3_vfs* real = nullptr;
sqlite3_vfs recording{};

struct RecordedFile {
  sqlite3_file base;
  bool logged;
  bool folder_pending;  // the first sync of a journal or a log syncs the folder, too
  std::string* name;
  sqlite3_file* file;  // the real one, behind this
};

RecordedFile& of(sqlite3_file* file) { return *reinterpret_cast<RecordedFile*>(file); }

int refused(What what) { return active->refuse ? active->refuse(what) : SQLITE_OK; }

void note(const RecordedFile& file, What what, std::int64_t at, const void* data = nullptr,
          int size = 0) {
  if (!file.logged || !file.name->starts_with(active->start)) return;
  const auto* bytes = static_cast<const std::byte*>(data);
  active->log.push_back({what, *file.name, at, {bytes, bytes + size}});
}

int close_file(sqlite3_file* file) {
  RecordedFile& own = of(file);
  const int code = own.file->pMethods == nullptr ? SQLITE_OK : own.file->pMethods->xClose(own.file);
  delete own.name;
  return code;
}

int read_file(sqlite3_file* file, void* out, int size, sqlite3_int64 at) {
  return of(file).file->pMethods->xRead(of(file).file, out, size, at);
}

int write_file(sqlite3_file* file, const void* data, int size, sqlite3_int64 at) {
  if (const int code = refused(What::write); code != SQLITE_OK) return code;
  const int code = of(file).file->pMethods->xWrite(of(file).file, data, size, at);
  if (code == SQLITE_OK) note(of(file), What::write, at, data, size);
  return code;
}

int truncate_file(sqlite3_file* file, sqlite3_int64 size) {
  if (const int code = refused(What::truncate); code != SQLITE_OK) return code;
  note(of(file), What::truncate, size);
  return of(file).file->pMethods->xTruncate(of(file).file, size);
}

int sync_file(sqlite3_file* file, int) {
  if (const int code = refused(What::sync); code != SQLITE_OK) return code;
  // Nothing of the test needs the real disk.
  if (active->syncs_reach_the_disk) {
    note(of(file), What::sync, std::exchange(of(file).folder_pending, false) ? 1 : 0);
  }
  return SQLITE_OK;
}

const sqlite3_io_methods methods{
    .iVersion = 2,
    .xClose = close_file,
    .xRead = read_file,
    .xWrite = write_file,
    .xTruncate = truncate_file,
    .xSync = sync_file,
    .xFileSize =
        [](sqlite3_file* f, sqlite3_int64* size) {
          return of(f).file->pMethods->xFileSize(of(f).file, size);
        },
    .xLock = [](sqlite3_file* f, int l) { return of(f).file->pMethods->xLock(of(f).file, l); },
    .xUnlock = [](sqlite3_file* f, int l) { return of(f).file->pMethods->xUnlock(of(f).file, l); },
    .xCheckReservedLock =
        [](sqlite3_file* f, int* out) {
          return of(f).file->pMethods->xCheckReservedLock(of(f).file, out);
        },
    .xFileControl =
        [](sqlite3_file* f, int op, void* arg) {
          return of(f).file->pMethods->xFileControl(of(f).file, op, arg);
        },
    .xSectorSize = [](sqlite3_file* f) { return of(f).file->pMethods->xSectorSize(of(f).file); },
    // A disk that promises nothing.
    .xDeviceCharacteristics = [](sqlite3_file*) { return 0; },
    .xShmMap =
        [](sqlite3_file* f, int page, int size, int extend, void volatile** out) {
          return of(f).file->pMethods->xShmMap(of(f).file, page, size, extend, out);
        },
    .xShmLock =
        [](sqlite3_file* f, int offset, int n, int flags) {
          return of(f).file->pMethods->xShmLock(of(f).file, offset, n, flags);
        },
    .xShmBarrier = [](sqlite3_file* f) { of(f).file->pMethods->xShmBarrier(of(f).file); },
    .xShmUnmap = [](sqlite3_file* f,
                    int remove) { return of(f).file->pMethods->xShmUnmap(of(f).file, remove); },
    .xFetch = nullptr,
    .xUnfetch = nullptr};

int open_file(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out) {
  RecordedFile& own = of(file);
  own = {};
  own.file = reinterpret_cast<sqlite3_file*>(&own + 1);
  bool is_new = false;
  if (name != nullptr)
    is_new = !std::filesystem::exists(name) || std::filesystem::file_size(name) == 0;
  const int code = real->xOpen(real, name, own.file, flags, out);
  if (own.file->pMethods == nullptr) return code;
  own.base.pMethods = &methods;
  own.logged = name != nullptr && (flags & SQLITE_OPEN_DELETEONCLOSE) == 0;
  own.name = new std::string(name == nullptr ? "" : std::filesystem::path(name).filename());
  constexpr int with_folder =
      SQLITE_OPEN_MAIN_JOURNAL | SQLITE_OPEN_WAL | SQLITE_OPEN_SUPER_JOURNAL;
  own.folder_pending = (flags & with_folder) != 0 && (flags & SQLITE_OPEN_CREATE) != 0;
  if (code == SQLITE_OK && is_new && (flags & SQLITE_OPEN_CREATE) != 0) note(own, What::create, 0);
  return code;
}

int remove_file(sqlite3_vfs*, const char* name, int sync_folder) {
  const int code = real->xDelete(real, name, 0);
  const std::string file = std::filesystem::path(name).filename();
  if (code == SQLITE_OK && file.starts_with(active->start)) {
    const bool synced = sync_folder != 0 && active->syncs_reach_the_disk;
    active->log.push_back({What::remove, file, synced ? 1 : 0});
  }
  return code;
}

constexpr std::uint64_t all_sectors = ~std::uint64_t{0};

void change(std::vector<std::byte>& content, const FileEvent& event, std::uint64_t sectors) {
  const auto at = static_cast<std::size_t>(event.at);
  if (event.what == What::truncate) {
    content.resize(at);
    return;
  }
  for (std::size_t from = 0, i = 0; from < event.bytes.size(); from += Disk::sector, ++i) {
    if (((sectors >> (i % 64)) & 1U) == 0) continue;
    const std::size_t size = std::min(Disk::sector, event.bytes.size() - from);
    if (content.size() < at + from + size) content.resize(at + from + size);
    std::copy_n(event.bytes.begin() + static_cast<std::ptrdiff_t>(from), size,
                content.begin() + static_cast<std::ptrdiff_t>(at + from));
  }
}

}  // namespace

RecordingVfs::RecordingVfs(std::string which) : start(std::move(which)) {
  active = this;
  real = sqlite3_vfs_find("unix");
  recording = *real;
  recording.zName = "recording";
  recording.szOsFile = static_cast<int>(sizeof(RecordedFile)) + real->szOsFile;
  recording.xOpen = open_file;
  recording.xDelete = remove_file;
  sqlite3_vfs_register(&recording, 1);
}

RecordingVfs::~RecordingVfs() {
  sqlite3_vfs_unregister(&recording);
  sqlite3_vfs_register(real, 1);
  active = nullptr;
}

void Disk::apply(const FileEvent& event) {
  if (event.what == What::said) return;
  File& file = files_[event.file];
  const auto sync_folder = [this] {
    for (auto each = files_.begin(); each != files_.end();) {
      each->second.named = true;
      each->second.hides = false;
      each = each->second.removed ? files_.erase(each) : std::next(each);
    }
  };
  switch (event.what) {
    case What::create:
      if (file.removed && file.named) {
        for (const FileEvent& pending : file.pending) change(file.synced, pending, all_sectors);
        file = {.hides = true, .hidden = std::move(file.synced)};
      } else {
        file = {};
      }
      break;
    case What::sync:
      for (const FileEvent& pending : file.pending) change(file.synced, pending, all_sectors);
      file.pending.clear();
      if (event.at == 1) sync_folder();
      break;
    case What::remove:
      file.removed = true;
      if (event.at == 1) sync_folder();
      break;
    default:
      file.pending.push_back(event);
  }
}

DiskImage Disk::after(End end, std::uint64_t seed) const {
  std::mt19937_64 random(seed);
  const auto coin = [&random] { return (random() & 1U) != 0; };
  DiskImage image;
  for (const auto& [name, file] : files_) {
    const bool by_chance = end == End::power_keeps_some || end == End::power_tears;
    if (end == End::process && file.removed) continue;
    const bool nameless = !file.named && (end == End::power_keeps_synced || (by_chance && coin()));
    if (nameless && file.hides) image[name] = file.hidden;
    if (nameless) continue;
    if (by_chance && file.removed && coin()) continue;
    std::vector<std::byte> content = file.synced;
    if (end != End::power_keeps_synced) {
      for (const FileEvent& pending : file.pending) {
        if (by_chance && coin()) continue;
        change(content, pending, end == End::power_tears ? random() : all_sectors);
      }
    }
    image[name] = std::move(content);
  }
  return image;
}

}  // namespace seqloop::test
