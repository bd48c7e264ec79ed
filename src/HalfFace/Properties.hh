// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_PROPERTIES_HH
#define HFR_HALFFACE_PROPERTIES_HH

#include <array>
#include <concepts>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>
#include <utility>
#include <vector>

#include "HalfFace/Handles.hh"
#include "HalfFace/TupleMap.hh"

namespace hfr {

class TetMesh;

namespace detail {

/// Throws InvalidInput: property `name` of `kind` holds one type and was asked for as another.
[[noreturn]] void fail_property_type(std::string_view kind, std::string_view name,
                                     const std::type_info& holds, const std::type_info& asked);

/// std::vector<bool> packs bits, which two threads cannot write side by side; so bools are stored in this.
struct BoolCell {
  bool value;
};

class StoredProperty {
 public:
  explicit StoredProperty(std::string name) : name_(std::move(name)) {}
  virtual ~StoredProperty() = default;
  const std::string& name() const { return name_; }
  virtual const std::type_info& type() const = 0;
  /// Heap memory in bytes, without what values own themselves.
  virtual std::size_t memory_bytes() const = 0;

 protected:
  StoredProperty(const StoredProperty&) = default;

 private:
  std::string name_;
};

/// One value per vertex or cell.
class DenseStored : public StoredProperty {
 public:
  using StoredProperty::StoredProperty;
  virtual std::shared_ptr<DenseStored> clone() const = 0;
  virtual void resize(std::size_t n) = 0;
  virtual void copy(std::size_t from, std::size_t to) = 0;
  /// Value i moves to new_index[i] (Handle<…>::kInvalid: it is dropped).
  virtual void permute(std::span<const Index> new_index, std::size_t n_new) = 0;
};

template <class T>
class Dense final : public DenseStored {
 public:
  using Element = std::conditional_t<std::same_as<T, bool>, BoolCell, T>;

  Dense(std::string name, T default_value, std::size_t n)
      : DenseStored(std::move(name)), values(n, Element{default_value}), preset(std::move(default_value)) {}
  std::shared_ptr<DenseStored> clone() const override { return std::make_shared<Dense>(*this); }
  const std::type_info& type() const override { return typeid(T); }
  std::size_t memory_bytes() const override { return values.capacity() * sizeof(Element); }
  void resize(std::size_t n) override { values.resize(n, Element{preset}); }
  void copy(std::size_t from, std::size_t to) override { values[to] = values[from]; }
  void permute(std::span<const Index> new_index, std::size_t n_new) override {
    std::vector<Element> moved(n_new, Element{preset});
    for (std::size_t i = 0; i < new_index.size(); ++i)
      if (new_index[i] != VertexHandle::kInvalid) moved[new_index[i]] = std::move(values[i]);
    values = std::move(moved);
  }
  T& at(std::size_t i) {
    if constexpr (std::same_as<T, bool>)
      return values[i].value;
    else
      return values[i];
  }

  std::vector<Element> values;
  T preset;
};

/// Values keyed by vertices: per edge, half-edge, face or half-face.
class TupleStored : public StoredProperty {
 public:
  using StoredProperty::StoredProperty;
  virtual std::shared_ptr<TupleStored> clone() const = 0;
  /// Follows a renumbering of vertices; values of what no cell of the mesh has any more are dropped.
  virtual void rename(const TetMesh& mesh, const std::vector<VertexHandle>& to) = 0;
};

template <std::size_t N, class T, class Order>
class Tuples final : public TupleStored {
 public:
  Tuples(std::string name, T default_value)
      : TupleStored(std::move(name)), preset(std::move(default_value)) {}
  std::shared_ptr<TupleStored> clone() const override { return std::make_shared<Tuples>(*this); }
  const std::type_info& type() const override { return typeid(T); }
  std::size_t memory_bytes() const override { return values.memory_bytes(); }
  void rename(const TetMesh& mesh, const std::vector<VertexHandle>& to) override {
    const std::vector<std::uint8_t> used = used_entries(mesh, values);  // of TupleUse.hh
    std::size_t i = 0;
    values.rename_vertices([&](VertexHandle v) { return to[v.idx()]; },
                           [&](const auto&) { return used[i++] != 0; });
  }

  TupleMap<N, T, Order> values;
  T preset;
};

/// One value for the mesh.
class SingleStored : public StoredProperty {
 public:
  using StoredProperty::StoredProperty;
  virtual std::shared_ptr<SingleStored> clone() const = 0;
};

template <class T>
class Single final : public SingleStored {
 public:
  Single(std::string name, T v) : SingleStored(std::move(name)), value(std::move(v)) {}
  std::shared_ptr<SingleStored> clone() const override { return std::make_shared<Single>(*this); }
  const std::type_info& type() const override { return typeid(T); }
  std::size_t memory_bytes() const override { return sizeof(T); }

  T value;
};

/// The properties of one kind that a mesh has, in the order in which they came. A copy has copies of the
/// values.
template <class Stored>
class PropertyList {
 public:
  explicit PropertyList(std::string_view kind) : kind_(kind) {}
  PropertyList(const PropertyList& other) : kind_(other.kind_) {
    for (const auto& p : other.list_) list_.push_back(p->clone());
  }
  PropertyList& operator=(const PropertyList& other) {
    if (this != &other) list_ = PropertyList(other).list_;
    return *this;
  }
  PropertyList(PropertyList&&) noexcept = default;
  PropertyList& operator=(PropertyList&&) noexcept = default;
  ~PropertyList() = default;

  bool empty() const { return list_.empty(); }
  auto begin() const { return list_.begin(); }
  auto end() const { return list_.end(); }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& p : list_) all.push_back(p->name());
    return all;
  }
  std::size_t memory_bytes() const {
    std::size_t sum = 0;
    for (const auto& p : list_) sum += p->memory_bytes();
    return sum;
  }
  /// The mesh forgets it; handles that were given out keep the values but follow the mesh no more.
  bool remove(std::string_view name) {
    return std::erase_if(list_, [&](const auto& p) { return p->name() == name; }) > 0;
  }

  /// nullptr when there is none of the name; throws InvalidInput when it holds another type.
  template <class Concrete>
  std::shared_ptr<Concrete> find(std::string_view name, const std::type_info& asked) const {
    for (const auto& p : list_) {
      if (p->name() != name) continue;
      if (p->type() != asked) fail_property_type(kind_, name, p->type(), asked);
      return std::static_pointer_cast<Concrete>(p);
    }
    return nullptr;
  }
  void add(std::shared_ptr<Stored> property) { list_.push_back(std::move(property)); }

 private:
  std::string_view kind_;
  std::vector<std::shared_ptr<Stored>> list_;
};

}  // namespace detail

/// A value of type T per vertex or cell, in one array. The handle is a cheap reference: copies of it mean the
/// same values, which live in the mesh and follow it. Writing different elements from several threads is
/// safe.
template <class H, class T>
class DenseProperty {
 public:
  explicit DenseProperty(std::shared_ptr<detail::Dense<T>> stored) : stored_(std::move(stored)) {}

  T& operator[](H h) { return stored_->at(h.idx()); }
  const T& operator[](H h) const { return stored_->at(h.idx()); }
  T& operator[](std::size_t) = delete;  ///< take a handle
  const T& operator[](std::size_t) const = delete;

  std::size_t size() const { return stored_->values.size(); }
  const std::string& name() const { return stored_->name(); }
  const T& default_value() const { return stored_->preset; }
  void fill(const T& value) {
    for (auto& element : stored_->values) element = typename detail::Dense<T>::Element{value};
  }
  /// All values by index; valid until the mesh grows or is compacted.
  std::span<T> values() requires(!std::same_as<T, bool>) { return stored_->values; }

 private:
  std::shared_ptr<detail::Dense<T>> stored_;
};

/// A value of type T per edge, half-edge, face or half-face, kept only where one was set, under the vertices:
/// so it survives every operator that keeps the thing, and handles of edges and faces may change meanwhile. A
/// thing that vanishes and is made anew has its old value again; collect_garbage() drops the values of what
/// is gone.
template <class H, std::size_t N, class T, class Order>
class TupleProperty {
 public:
  using Key = std::array<VertexHandle, N>;

  explicit TupleProperty(std::shared_ptr<detail::Tuples<N, T, Order>> stored) : stored_(std::move(stored)) {}

  /// The value, or the default where none was set. Thread-safe while nobody writes.
  const T& get(const Key& vertices) const {
    const T* found = stored_->values.find(vertices);
    return found ? *found : stored_->preset;
  }
  const T& get(const TetMesh& mesh, H h) const { return get(vertices_of(mesh, h)); }
  /// A reference to the value, stored now if it was not; valid until the next value is stored. Not
  /// thread-safe.
  T& operator[](const Key& vertices) {
    T* found = stored_->values.find(vertices);
    return found ? *found : stored_->values.set(vertices, stored_->preset);
  }
  T& at(const TetMesh& mesh, H h) { return (*this)[vertices_of(mesh, h)]; }
  void set(const TetMesh& mesh, H h, T value) { stored_->values.set(vertices_of(mesh, h), std::move(value)); }

  bool has(const Key& vertices) const { return stored_->values.find(vertices) != nullptr; }
  bool erase(const Key& vertices) { return stored_->values.erase(vertices); }
  /// What was set, in order of setting.
  auto entries() const { return stored_->values.entries(); }
  std::size_t size() const { return stored_->values.size(); }  ///< number of values that were set
  const std::string& name() const { return stored_->name(); }
  const T& default_value() const { return stored_->preset; }

 private:
  std::shared_ptr<detail::Tuples<N, T, Order>> stored_;
};

/// One value of type T for the whole mesh.
template <class T>
class MeshProperty {
 public:
  explicit MeshProperty(std::shared_ptr<detail::Single<T>> stored) : stored_(std::move(stored)) {}
  T& operator*() { return stored_->value; }
  const T& operator*() const { return stored_->value; }
  T* operator->() { return &stored_->value; }
  const T* operator->() const { return &stored_->value; }
  const std::string& name() const { return stored_->name(); }

 private:
  std::shared_ptr<detail::Single<T>> stored_;
};

template <class T>
using VertexProperty = DenseProperty<VertexHandle, T>;
template <class T>
using CellProperty = DenseProperty<CellHandle, T>;
template <class T>
using EdgeProperty = TupleProperty<EdgeHandle, 2, T, AnyOrder>;
template <class T>
using HalfEdgeProperty = TupleProperty<HalfEdgeHandle, 2, T, CyclicOrder>;
template <class T>
using FaceProperty = TupleProperty<FaceHandle, 3, T, AnyOrder>;
template <class T>
using HalfFaceProperty = TupleProperty<HalfFaceHandle, 3, T, CyclicOrder>;

/// All properties of a mesh; reach it through TetMesh::properties() for names and removal.
class PropertySet {
 public:
  using DenseList = detail::PropertyList<detail::DenseStored>;
  using TupleList = detail::PropertyList<detail::TupleStored>;
  using SingleList = detail::PropertyList<detail::SingleStored>;

  DenseList vertices{"vertex"};
  DenseList cells{"cell"};
  TupleList edges{"edge"};
  TupleList halfedges{"half-edge"};
  TupleList faces{"face"};
  TupleList halffaces{"half-face"};
  SingleList mesh{"mesh"};

  template <class T>
  static std::shared_ptr<detail::Dense<T>> request_dense(DenseList& list, std::string_view name,
                                                         const T& preset, std::size_t n) {
    auto found = list.template find<detail::Dense<T>>(name, typeid(T));
    if (!found) list.add(found = std::make_shared<detail::Dense<T>>(std::string(name), preset, n));
    return found;
  }
  template <std::size_t N, class T, class Order>
  static std::shared_ptr<detail::Tuples<N, T, Order>> request_tuples(TupleList& list, std::string_view name,
                                                                     const T& preset) {
    using Stored = detail::Tuples<N, T, Order>;
    auto found = list.template find<Stored>(name, typeid(T));
    if (!found) list.add(found = std::make_shared<Stored>(std::string(name), preset));
    return found;
  }
  template <class T>
  static std::shared_ptr<detail::Single<T>> request_single(SingleList& list, std::string_view name,
                                                           const T& preset) {
    auto found = list.template find<detail::Single<T>>(name, typeid(T));
    if (!found) list.add(found = std::make_shared<detail::Single<T>>(std::string(name), preset));
    return found;
  }

  void resize_vertices(std::size_t n) {
    for (const auto& p : vertices) p->resize(n);
  }
  void resize_cells(std::size_t n) {
    for (const auto& p : cells) p->resize(n);
  }
  /// Follows a renumbering, while `of` is still the mesh as it was.
  void renumber(const TetMesh& of, const std::vector<VertexHandle>& new_vertex, std::size_t n_vertices,
                const std::vector<CellHandle>& new_cell, std::size_t n_cells);
  std::size_t memory_bytes() const;
};

}  // namespace hfr

#endif
