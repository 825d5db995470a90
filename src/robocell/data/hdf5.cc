#include "robocell/data/hdf5.h"

#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>
#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <mutex>
#include <new>
#include <type_traits>
#include <utility>

#include "robocell/base/error.h"

namespace robocell::internal::hdf5 {
namespace {

static_assert(std::is_same_v<hid_t, int64_t> && std::is_same_v<herr_t, int>);

// Prepares the library on first use. Without H5dont_atexit a process whose disk was full crashes at
// its end. Code that forks, such as Python's multiprocessing, forks while no thread is in the
// library.
std::recursive_mutex& Mutex() {
  static std::recursive_mutex mutex;
  static const bool prepared = [] {
    H5dont_atexit();
    H5open();
    pthread_atfork([] { Mutex().lock(); }, [] { Mutex().unlock(); },
                   // The thread that holds it has another number in the child, so it cannot unlock.
                   [] { new (&Mutex()) std::recursive_mutex; });
    return true;
  }();
  (void)prepared;
  return mutex;
}

// Locks, and keeps the library from printing for this thread.
class Lock {
 public:
  Lock() : lock_(Mutex()) { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

 private:
  std::lock_guard<std::recursive_mutex> lock_;
};

herr_t KeepInnermost(unsigned, const H5E_error2_t* entry, void* text) {
  if (entry->desc != nullptr) *static_cast<std::string*>(text) = entry->desc;
  return 0;
}

// Returns the innermost reason; of the long texts for failed system calls only the system's words.
std::string Reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, KeepInnermost, &text);
  H5Eclear2(H5E_DEFAULT);
  constexpr std::string_view kMark = "error message = '";
  const size_t mark = text.find(kMark);
  if (mark == std::string::npos) return text.empty() ? "no reason given" : text;
  const size_t begin = mark + kMark.size();
  return text.substr(begin, text.find('\'', begin) - begin);
}

Id Own(hid_t id, Id::Closer closer) { return Id(id, closer); }
bool Bad(const Id& id) { return id.get() < 0; }

Id MakeBool() {
  Id type = Own(H5Tenum_create(H5T_STD_I8LE), H5Tclose);
  const int8_t values[] = {0, 1};
  H5Tenum_insert(type.get(), "FALSE", &values[0]);
  H5Tenum_insert(type.get(), "TRUE", &values[1]);
  return type;
}

// The type is the same in the file and in memory: robocell runs on little-endian machines.
Id TypeId(ColumnType type) {
  switch (type) {
    case ColumnType::kFloat64:
      return Own(H5Tcopy(H5T_IEEE_F64LE), H5Tclose);
    case ColumnType::kFloat32:
      return Own(H5Tcopy(H5T_IEEE_F32LE), H5Tclose);
    case ColumnType::kInt64:
      return Own(H5Tcopy(H5T_STD_I64LE), H5Tclose);
    case ColumnType::kInt32:
      return Own(H5Tcopy(H5T_STD_I32LE), H5Tclose);
    case ColumnType::kUint8:
      return Own(H5Tcopy(H5T_STD_U8LE), H5Tclose);
    default:
      return MakeBool();
  }
}

constexpr ColumnType kTypes[] = {ColumnType::kFloat64, ColumnType::kFloat32, ColumnType::kInt64,
                                 ColumnType::kInt32,   ColumnType::kUint8,   ColumnType::kBool};

// A foreign file must not expose the content of other files of this machine.
bool HasItsOwnNumbers(const Id& dataset) {
  const Id creation = Own(H5Dget_create_plist(dataset.get()), H5Pclose);
  return H5Pget_external_count(creation.get()) == 0 && H5Pget_layout(creation.get()) != H5D_VIRTUAL;
}

Id TextType() {
  Id type = Own(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

std::vector<hsize_t> Sizes(const std::vector<int64_t>& shape) {
  return {shape.begin(), shape.end()};
}

Id NoTimes(hid_t property_class) {
  Id list = Own(H5Pcreate(property_class), H5Pclose);
  H5Pset_obj_track_times(list.get(), false);
  return list;
}

bool WriteAttribute(hid_t object, const std::string& key, hid_t type, const Id& space,
                    const void* data) {
  Id attribute =
      Own(H5Acreate2(object, key.c_str(), type, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  return !Bad(attribute) && H5Awrite(attribute.get(), type, data) >= 0 && attribute.Close();
}

bool WriteText(hid_t object, const std::string& key, const std::string& value) {
  const char* data = value.c_str();
  return WriteAttribute(object, key, TextType().get(), Own(H5Screate(H5S_SCALAR), H5Sclose), &data);
}

bool WriteTexts(hid_t object, const std::string& key, const std::vector<std::string>& values) {
  std::vector<const char*> data;
  for (const std::string& value : values) data.push_back(value.c_str());
  const hsize_t count = data.size();
  return WriteAttribute(object, key, TextType().get(),
                        Own(H5Screate_simple(1, &count, nullptr), H5Sclose), data.data());
}

// Returns an empty list if there is no such attribute or it is not text.
std::vector<std::string> ReadTexts(hid_t object, const std::string& key) {
  std::vector<std::string> values;
  if (H5Aexists(object, key.c_str()) <= 0) return values;
  const Id attribute = Own(H5Aopen(object, key.c_str(), H5P_DEFAULT), H5Aclose);
  const Id stored = Own(H5Aget_type(attribute.get()), H5Tclose);
  if (H5Tis_variable_str(stored.get()) <= 0) return values;
  const Id space = Own(H5Aget_space(attribute.get()), H5Sclose);
  std::vector<char*> data(
      static_cast<size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space.get()), 0)));
  const Id type = TextType();
  if (data.empty() || H5Aread(attribute.get(), type.get(), data.data()) < 0) return values;
  for (const char* text : data) values.emplace_back(text == nullptr ? "" : text);
  H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, data.data());
  return values;
}

std::string FirstText(hid_t object, const std::string& key) {
  std::vector<std::string> values = ReadTexts(object, key);
  return values.empty() ? "" : values[0];
}

herr_t Collect(hid_t, const char* name, const H5O_info_t* info, void* names) {
  if (info->type == H5O_TYPE_DATASET)
    static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

}  // namespace

int Fork() {
  Mutex();
  return ::fork();
}

std::string Version() {
  unsigned major = 0;
  unsigned minor = 0;
  unsigned release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

Id::~Id() { Close(); }
Id::Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), closer_(other.closer_) {}
Id& Id::operator=(Id&& other) noexcept {
  Close();
  id_ = std::exchange(other.id_, -1);
  closer_ = other.closer_;
  return *this;
}

bool Id::Close() {
  if (id_ < 0) return true;
  const Lock lock;
  if (closer_(id_) < 0) return false;
  id_ = -1;
  return true;
}

// ---- H5Dataset

void H5Dataset::Fail(const std::string& what) const {
  throw IoError(fmt::format("'{}': cannot {} '{}': {}", file_, what, name_, Reason()));
}

size_t H5Dataset::row_bytes() const {
  const std::vector<int64_t> row(shape_.begin() + 1, shape_.end());
  return SizeOf(type_) * static_cast<size_t>(RowValues(row));
}

Id H5Dataset::SelectRows(int64_t first, int64_t count) const {
  Id space = Own(H5Dget_space(id_.get()), H5Sclose);
  std::vector<hsize_t> start(shape_.size(), 0);
  std::vector<hsize_t> sizes = Sizes(shape_);
  start[0] = static_cast<hsize_t>(first);
  sizes[0] = static_cast<hsize_t>(count);
  if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, sizes.data(),
                          nullptr) < 0) {
    Fail("select rows of");
  }
  return space;
}

// Bypasses the library's chunk cache, which leaks its buffer when a write fails.
void H5Dataset::AppendChunk(int64_t count, std::span<const std::byte> bytes) {
  const Lock lock;
  std::vector<hsize_t> offset(shape_.size(), 0);
  offset[0] = static_cast<hsize_t>(shape_[0]);
  shape_[0] += count;
  if (H5Dset_extent(id_.get(), Sizes(shape_).data()) < 0) Fail("extend");
  if (H5Dwrite_chunk(id_.get(), H5P_DEFAULT, 0, offset.data(), bytes.size(), bytes.data()) < 0)
    Fail("write");
}

void H5Dataset::ReadRows(int64_t first, int64_t count, std::span<std::byte> bytes) const {
  const Lock lock;
  if (bytes.size() != static_cast<size_t>(count) * row_bytes())
    throw Error("ReadRows: wrong number of bytes");
  if (count == 0) return;
  std::vector<hsize_t> sizes = Sizes(shape_);
  sizes[0] = static_cast<hsize_t>(count);
  const Id memory =
      Own(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose);
  const Id rows = SelectRows(first, count);
  if (H5Dread(id_.get(), TypeId(type_).get(), memory.get(), rows.get(), H5P_DEFAULT, bytes.data()) <
      0)
    Fail("read");
}

void H5Dataset::ReadAll(std::span<std::byte> bytes) const {
  const Lock lock;
  if (H5Dread(id_.get(), TypeId(type_).get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0)
    Fail("read");
}

void H5Dataset::WriteAll(std::span<const std::byte> bytes) {
  const Lock lock;
  if (H5Dwrite(id_.get(), TypeId(type_).get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0)
    Fail("write");
}

void H5Dataset::SetText(const std::string& key, const std::string& value) {
  const Lock lock;
  if (!WriteText(id_.get(), key, value)) Fail("set attribute " + key + " of");
}

void H5Dataset::SetTexts(const std::string& key, const std::vector<std::string>& values) {
  const Lock lock;
  if (!WriteTexts(id_.get(), key, values)) Fail("set attribute " + key + " of");
}

std::string H5Dataset::Text(const std::string& key) const {
  const Lock lock;
  return FirstText(id_.get(), key);
}

std::vector<std::string> H5Dataset::Texts(const std::string& key) const {
  const Lock lock;
  return ReadTexts(id_.get(), key);
}

void H5Dataset::Close() {
  const Lock lock;
  if (!id_.Close()) Fail("close");
}

// ---- File

void File::Fail(const std::string& what) const {
  throw IoError(fmt::format("'{}': cannot {}: {}", path_, what, Reason()));
}

namespace {

// HDF5's own locks are switched off: a child process that inherits the descriptor would hold them
// longer than this file is open, and a dataset has locks of its own (dataset_lock.h).
Id FileAccess() {
  Id access = Own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_file_locking(access.get(), false, true);
  return access;
}

}  // namespace

File File::Create(const std::filesystem::path& path) {
  const Lock lock;
  const Id creation = NoTimes(H5P_FILE_CREATE);
  const Id access = FileAccess();
  H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG);
  File file(Own(H5Fcreate(path.c_str(), H5F_ACC_EXCL, creation.get(), access.get()), H5Fclose),
            path.string());
  if (Bad(file.id_)) file.Fail("create it");
  return file;
}

File File::OpenReadOnly(const std::filesystem::path& path) {
  const Lock lock;
  const Id access = FileAccess();
  File file(Own(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose), path.string());
  if (Bad(file.id_)) file.Fail("open it");
  return file;
}

File File::OpenBytes(std::string bytes, const std::filesystem::path& path) {
  const Lock lock;
  const Id access = FileAccess();
  constexpr size_t kIncrement = 1 << 16;  // for files that grow; this one does not
  const bool ready = H5Pset_fapl_core(access.get(), kIncrement, false) >= 0 &&
                     H5Pset_file_image(access.get(), bytes.data(), bytes.size()) >= 0;
  // The library refuses the name of a file that exists, and takes equal names for the same bytes.
  static uint64_t count = 0;
  const std::string name = fmt::format("{}.{}.bytes", path.string(), ++count);
  File file(ready ? Own(H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose) : Id(),
            path.string());
  if (Bad(file.id_)) file.Fail("open it");
  return file;
}

Id File::Group(const std::string& name) {
  if (name != "/") MakeParents(name + "/");
  Id group = Own(H5Gopen2(id_.get(), name.c_str(), H5P_DEFAULT), H5Gclose);
  if (Bad(group)) Fail("open group " + name);
  return group;
}

void File::MakeParents(const std::string& name) {
  const Id creation = NoTimes(H5P_GROUP_CREATE);
  for (size_t slash = name.find('/'); slash != std::string::npos;
       slash = name.find('/', slash + 1)) {
    const std::string group = name.substr(0, slash);
    if (H5Lexists(id_.get(), group.c_str(), H5P_DEFAULT) > 0) continue;
    const Id made = Own(
        H5Gcreate2(id_.get(), group.c_str(), H5P_DEFAULT, creation.get(), H5P_DEFAULT), H5Gclose);
    if (Bad(made)) Fail("create group " + group);
  }
}

H5Dataset File::Created(Id id, const std::string& name, ColumnType type,
                        std::vector<int64_t> shape) const {
  if (Bad(id)) Fail("create array " + name);
  H5Dataset dataset;
  dataset.id_ = std::move(id);
  dataset.file_ = path_;
  dataset.name_ = name;
  dataset.type_ = type;
  dataset.shape_ = std::move(shape);
  return dataset;
}

H5Dataset File::CreateExtendible(const std::string& name, ColumnType type,
                                 const std::vector<int64_t>& shape, int64_t chunk_rows) {
  const Lock lock;
  MakeParents(name);
  std::vector<int64_t> full = shape;
  full.insert(full.begin(), 0);
  std::vector<hsize_t> most = Sizes(full);
  std::vector<hsize_t> chunk = most;
  most[0] = H5S_UNLIMITED;
  chunk[0] = static_cast<hsize_t>(chunk_rows);
  const Id space = Own(
      H5Screate_simple(static_cast<int>(full.size()), Sizes(full).data(), most.data()), H5Sclose);
  const Id creation = NoTimes(H5P_DATASET_CREATE);
  H5Pset_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data());
  return Created(Own(H5Dcreate2(id_.get(), name.c_str(), TypeId(type).get(), space.get(),
                                H5P_DEFAULT, creation.get(), H5P_DEFAULT),
                     H5Dclose),
                 name, type, full);
}

H5Dataset File::CreateFixed(const std::string& name, ColumnType type,
                            const std::vector<int64_t>& shape) {
  const Lock lock;
  MakeParents(name);
  const Id space =
      Own(H5Screate_simple(static_cast<int>(shape.size()), Sizes(shape).data(), nullptr), H5Sclose);
  const Id creation = NoTimes(H5P_DATASET_CREATE);
  return Created(Own(H5Dcreate2(id_.get(), name.c_str(), TypeId(type).get(), space.get(),
                                H5P_DEFAULT, creation.get(), H5P_DEFAULT),
                     H5Dclose),
                 name, type, shape);
}

H5Dataset File::Open(const std::string& name) const {
  const Lock lock;
  Id id = Own(H5Dopen2(id_.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
  if (Bad(id)) Fail("open array " + name);
  if (!HasItsOwnNumbers(id)) Fail("read array " + name + ", its numbers are kept in other files");
  const Id stored = Own(H5Dget_type(id.get()), H5Tclose);
  const auto* type = std::find_if(std::begin(kTypes), std::end(kTypes), [&](ColumnType candidate) {
    return H5Tequal(stored.get(), TypeId(candidate).get()) > 0;
  });
  if (type == std::end(kTypes)) Fail("read array " + name + ", its type is unknown");
  const Id space = Own(H5Dget_space(id.get()), H5Sclose);
  std::vector<hsize_t> sizes(
      static_cast<size_t>(std::max(H5Sget_simple_extent_ndims(space.get()), 0)));
  H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr);
  return Created(std::move(id), name, *type, {sizes.begin(), sizes.end()});
}

std::vector<std::string> File::DatasetNames() const {
  const Lock lock;
  std::vector<std::string> names;
  if (H5Ovisit(id_.get(), H5_INDEX_NAME, H5_ITER_INC, Collect, &names) < 0) Fail("list its arrays");
  return names;
}

void File::SetText(const std::string& group, const std::string& key, const std::string& value) {
  const Lock lock;
  if (!WriteText(Group(group).get(), key, value)) Fail("set attribute " + key + " of " + group);
}

void File::SetInteger(const std::string& group, const std::string& key, int64_t value) {
  const Lock lock;
  const Id object = Group(group);
  if (!WriteAttribute(object.get(), key, H5T_STD_I64LE, Own(H5Screate(H5S_SCALAR), H5Sclose),
                      &value)) {
    Fail("set attribute " + key + " of " + group);
  }
}

std::string File::Text(const std::string& group, const std::string& key) const {
  const Lock lock;
  const Id object = Own(H5Gopen2(id_.get(), group.c_str(), H5P_DEFAULT), H5Gclose);
  if (Bad(object)) Fail("open group " + group);
  return FirstText(object.get(), key);
}

int64_t File::Integer(const std::string& group, const std::string& key) const {
  const Lock lock;
  const Id attribute = Own(
      H5Aopen_by_name(id_.get(), group.c_str(), key.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  int64_t value = 0;
  if (Bad(attribute) || H5Aread(attribute.get(), H5T_NATIVE_INT64, &value) < 0) {
    Fail("read attribute " + key + " of " + group);
  }
  return value;
}

void File::Close() {
  const Lock lock;
  const bool flushed = id_.get() < 0 || H5Fflush(id_.get(), H5F_SCOPE_GLOBAL) >= 0;
  if (!flushed) Fail("write it out");
  if (id_.Close()) return;
  id_.Forget();  // the library has freed the file but kept its id, which now points nowhere
  Fail("close it");
}

void File::Discard() noexcept {
  const Lock lock;
  void* handle = nullptr;  // the default driver's: its file descriptor
  if (id_.get() < 0 || H5Fget_vfd_handle(id_.get(), H5P_DEFAULT, &handle) < 0) return;
  const int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
  if (nowhere < 0) return;
  dup3(nowhere, *static_cast<int*>(handle), O_CLOEXEC);
  close(nowhere);
}

}  // namespace robocell::internal::hdf5
