// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_PROPERTIES_HH
#define HFR_HALFFACE_PROPERTIES_HH

#include <algorithm>
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

#include "hfremesh/HalfFace/Handles.hh"
#include "hfremesh/HalfFace/TupleMap.hh"

namespace hfr {

class TetMesh;

namespace detail {

/// Throws InvalidInput: property `name` has no value for index i, having n.
[[noreturn]] void fail_property_index(std::string_view name, std::size_t i, std::size_t n);
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
  /// Without a name it lives as long as somebody besides the mesh holds it.
  bool is_anonymous() const { return name_.empty(); }
  virtual const std::type_info& type() const = 0;
  /// Heap memory in bytes, without what values own themselves.
  virtual std::size_t memory_bytes() const = 0;
  /// Takes the values and the default of another property of the same type, which keeps nothing of use.
  virtual void take(StoredProperty& other) = 0;
  /// Forgets the values: a dense one then has n defaults, one that is kept by vertices none. A single one
  /// stays what it is.
  virtual void reset(std::size_t n) = 0;

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
  /// Takes a value of another property of the same type.
  virtual void copy_from(const DenseStored& source, std::size_t from, std::size_t to) = 0;
  virtual void swap(std::size_t i, std::size_t j) = 0;
  /// Value i moves to new_index[i] (Handle<…>::kInvalid: it is dropped).
  virtual void permute(std::span<const Index> new_index, std::size_t n_new) = 0;
};

/// Whether what is kept stays in its order, without gaps.
inline bool keeps_order(std::span<const Index> new_index) {
  Index next = 0;
  for (const Index i : new_index)
    if (i != VertexHandle::kInvalid && i != next++) return false;
  return true;
}

template <class T>
class Dense final : public DenseStored {
 public:
  using Element = std::conditional_t<std::same_as<T, bool>, BoolCell, T>;

  Dense(std::string name, T default_value, std::size_t n)
      : DenseStored(std::move(name)), values(n, Element{default_value}), preset(std::move(default_value)) {}
  std::shared_ptr<DenseStored> clone() const override { return std::make_shared<Dense>(*this); }
  const std::type_info& type() const override { return typeid(T); }
  std::size_t memory_bytes() const override { return values.capacity() * sizeof(Element); }
  void take(StoredProperty& other) override {
    values.swap(static_cast<Dense&>(other).values);
    preset = static_cast<Dense&>(other).preset;
  }
  void reset(std::size_t n) override { values.assign(n, Element{preset}); }
  void resize(std::size_t n) override { values.resize(n, Element{preset}); }
  void copy(std::size_t from, std::size_t to) override { values[to] = values[from]; }
  void copy_from(const DenseStored& source, std::size_t from, std::size_t to) override {
    values[to] = static_cast<const Dense&>(source).values[from];
  }
  void swap(std::size_t i, std::size_t j) override { std::swap(values[i], values[j]); }
  void permute(std::span<const Index> new_index, std::size_t n_new) override {
    if (keeps_order(new_index)) {  // in place: nothing is allocated
      for (std::size_t i = 0; i < new_index.size(); ++i)
        if (new_index[i] != VertexHandle::kInvalid && new_index[i] != i)
          values[new_index[i]] = std::move(values[i]);
      values.resize(n_new, Element{preset});
      return;
    }
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
  /// a becomes b and b becomes a.
  virtual void exchange(VertexHandle a, VertexHandle b) = 0;
  /// The thing of vertices `to` gets the value of the thing of `from`, either way round, unless it has one;
  /// both have as many vertices as a key.
  virtual void inherit(const VertexHandle* from, const VertexHandle* to) = 0;
  /// The same whatever it has, which is of a thing that is not there any more.
  virtual void replace(const VertexHandle* from, const VertexHandle* to) = 0;
};

template <std::size_t N, class T, class Order>
class Tuples final : public TupleStored {
 public:
  Tuples(std::string name, T default_value)
      : TupleStored(std::move(name)), preset(std::move(default_value)) {}
  std::shared_ptr<TupleStored> clone() const override { return std::make_shared<Tuples>(*this); }
  const std::type_info& type() const override { return typeid(T); }
  std::size_t memory_bytes() const override { return values.memory_bytes(); }
  void take(StoredProperty& other) override {
    values = std::move(static_cast<Tuples&>(other).values);
    preset = static_cast<Tuples&>(other).preset;
  }
  void reset(std::size_t) override { values = {}; }
  void rename(const TetMesh& mesh, const std::vector<VertexHandle>& to) override {
    const std::vector<std::uint8_t> used = used_entries(mesh, values);  // of TupleUse.hh
    std::size_t i = 0;
    values.rename_vertices([&](VertexHandle v) { return to[v.idx()]; },
                           [&](const auto&) { return used[i++] != 0; });
  }
  void exchange(VertexHandle a, VertexHandle b) override {
    values.rename_vertices([&](VertexHandle v) { return v == a   ? b
                                                        : v == b ? a
                                                                 : v; },
                           [](const auto&) { return true; });
  }
  void inherit(const VertexHandle* from, const VertexHandle* to) override {
    for_ways(from, to, [&](const auto& there, const auto& here) {
      const T* found = values.find(there);
      if (found && !values.find(here)) values.set(here, T(*found));
    });
  }
  void replace(const VertexHandle* from, const VertexHandle* to) override {
    for_ways(from, to, [&](const auto& there, const auto& here) {
      if (const T* found = values.find(there))
        values.set(here, T(*found));
      else
        values.erase_unordered(here);
    });
  }

  TupleMap<N, T, Order> values;
  T preset;

 private:
  template <class Visit>
  static void for_ways(const VertexHandle* from, const VertexHandle* to, Visit&& visit) {
    std::array<VertexHandle, N> there, here;
    std::copy_n(from, N, there.begin());
    std::copy_n(to, N, here.begin());
    for (int way = 0; way < (Order::kDirected ? 2 : 1); ++way) {
      visit(there, here);
      std::reverse(there.begin(), there.end());
      std::reverse(here.begin(), here.end());
    }
  }
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
  void take(StoredProperty& other) override { value = std::move(static_cast<Single&>(other).value); }
  void reset(std::size_t) override {}

  T value;
};

/// The properties of one kind that a mesh has, in the order in which they came. A copy has copies of all
/// values; those without a name nobody holds there, so they go when another property is added.
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
    for (const auto& p : list_)
      if (!p->is_anonymous()) all.push_back(p->name());
    return all;
  }
  std::size_t memory_bytes() const {
    std::size_t sum = 0;
    for (const auto& p : list_) sum += p->memory_bytes();
    return sum;
  }
  /// The mesh forgets it; handles that were given out keep the values but follow the mesh no more. Those
  /// without a name cannot be asked for, and stay.
  bool remove(std::string_view name) {
    return !name.empty() && std::erase_if(list_, [&](const auto& p) { return p->name() == name; }) > 0;
  }
  /// Forgets those without a name that nobody else holds any more.
  void drop_unheld() {
    std::erase_if(list_, [](const auto& p) { return p->is_anonymous() && p.use_count() == 1; });
  }

  /// nullptr when there is none of the name, as for no name; throws InvalidInput when it holds another type.
  template <class Concrete>
  std::shared_ptr<Concrete> find(std::string_view name, const std::type_info& asked) const {
    if (name.empty()) return nullptr;
    for (const auto& p : list_) {
      if (p->name() != name) continue;
      if (p->type() != asked) fail_property_type(kind_, name, p->type(), asked);
      return std::static_pointer_cast<Concrete>(p);
    }
    return nullptr;
  }
  void add(std::shared_ptr<Stored> property) {
    drop_unheld();
    list_.push_back(std::move(property));
  }
  /// Takes the values of `saved`, a copy of this list at an earlier time, into the storage that handles know;
  /// a property that `saved` lacks, or has of another type, is reset to n values, and a named one that this
  /// list has lost comes back. Those without a name are told apart by their order.
  void take(PropertyList& saved, std::size_t n) {
    std::vector<std::uint8_t> taken(saved.list_.size(), 0);
    for (const auto& p : list_) {
      std::size_t i = 0;
      while (i < taken.size() && (taken[i] || saved.list_[i]->name() != p->name())) ++i;
      const bool found = i < taken.size();
      if (found) taken[i] = 1;
      if (found && saved.list_[i]->type() == p->type())
        p->take(*saved.list_[i]);
      else
        p->reset(n);
    }
    for (std::size_t i = 0; i < taken.size(); ++i)
      if (!taken[i] && !saved.list_[i]->is_anonymous()) list_.push_back(std::move(saved.list_[i]));
  }

 private:
  std::string_view kind_;
  std::vector<std::shared_ptr<Stored>> list_;
};

}  // namespace detail

/// A value of type T per vertex or cell, in one array. The handle is a cheap reference: copies of it mean the
/// same values, which live in the mesh and follow it. Writing different elements from several threads is
/// safe. With a const T it only reads.
template <class H, class T>
class DenseProperty {
 public:
  using Value = std::remove_const_t<T>;
  using Stored = detail::Dense<Value>;
  static constexpr bool kWritable = !std::is_const_v<T>;

  explicit DenseProperty(std::shared_ptr<Stored> stored) : stored_(std::move(stored)) {}
  template <std::same_as<Value> U>
  DenseProperty(const DenseProperty<H, U>& writable) requires(!kWritable) : stored_(writable.stored_) {}

  T& operator[](H h) requires kWritable { return stored_->at(h.idx()); }
  const T& operator[](H h) const { return stored_->at(h.idx()); }
  T& operator[](std::size_t) = delete;  ///< take a handle
  const T& operator[](std::size_t) const = delete;
  /// The same, but throws InvalidInput for a handle that the mesh does not have.
  T& at(H h) requires kWritable { return stored_->at(checked(h)); }
  const T& at(H h) const { return stored_->at(checked(h)); }

  std::size_t size() const { return stored_->values.size(); }
  const std::string& name() const { return stored_->name(); }
  const T& default_value() const { return stored_->preset; }
  void fill(const T& value) requires kWritable {
    for (auto& element : stored_->values) element = typename Stored::Element{value};
  }
  /// All values by index; valid until the mesh grows or is compacted.
  std::span<T> values() requires(kWritable && !std::same_as<Value, bool>) { return stored_->values; }
  std::span<const Value> values() const requires(!std::same_as<Value, bool>) { return stored_->values; }

 private:
  template <class, class>
  friend class DenseProperty;
  std::size_t checked(H h) const {
    if (h.idx() >= size()) detail::fail_property_index(name(), h.idx(), size());
    return h.idx();
  }
  std::shared_ptr<Stored> stored_;
};

/// A value of type T per edge, half-edge, face or half-face, kept only where one was set, under the vertices:
/// so it survives every operator that keeps the thing, and handles of edges and faces may change meanwhile. A
/// thing that vanishes and is made anew has its old value again; collect_garbage() drops the values of what
/// is gone. With a const T it only reads.
template <class H, std::size_t N, class T, class Order>
class TupleProperty {
 public:
  using Key = std::array<VertexHandle, N>;
  using Value = std::remove_const_t<T>;
  using Stored = detail::Tuples<N, Value, Order>;
  static constexpr bool kWritable = !std::is_const_v<T>;

  explicit TupleProperty(std::shared_ptr<Stored> stored) : stored_(std::move(stored)) {}
  template <std::same_as<Value> U>
  TupleProperty(const TupleProperty<H, N, U, Order>& writable) requires(!kWritable)
      : stored_(writable.stored_) {}

  /// The value, or the default where none was set. Thread-safe while nobody writes.
  const T& get(const Key& vertices) const {
    const Value* found = std::as_const(stored_->values).find(vertices);
    return found ? *found : stored_->preset;
  }
  const T& get(const TetMesh& mesh, H h) const { return get(vertices_of(mesh, h)); }
  /// A reference to the value, stored now if it was not; valid until the next value is stored. Not
  /// thread-safe.
  T& operator[](const Key& vertices) requires kWritable {
    T* found = stored_->values.find(vertices);
    return found ? *found : stored_->values.set(vertices, stored_->preset);
  }
  T& at(const TetMesh& mesh, H h) requires kWritable { return (*this)[vertices_of(mesh, h)]; }
  void set(const TetMesh& mesh, H h, T value) requires kWritable {
    stored_->values.set(vertices_of(mesh, h), std::move(value));
  }

  bool has(const Key& vertices) const { return stored_->values.find(vertices) != nullptr; }
  bool erase(const Key& vertices) requires kWritable { return stored_->values.erase(vertices); }
  /// What was set, in order of setting.
  auto entries() const { return stored_->values.entries(); }
  std::size_t size() const { return stored_->values.size(); }  ///< number of values that were set
  const std::string& name() const { return stored_->name(); }
  const T& default_value() const { return stored_->preset; }

 private:
  template <class, std::size_t, class, class>
  friend class TupleProperty;
  std::shared_ptr<Stored> stored_;
};

/// One value of type T for the whole mesh; read-only with a const T.
template <class T>
class MeshProperty {
 public:
  using Value = std::remove_const_t<T>;
  using Stored = detail::Single<Value>;

  explicit MeshProperty(std::shared_ptr<Stored> stored) : stored_(std::move(stored)) {}
  T& operator*() { return stored_->value; }
  const T& operator*() const { return stored_->value; }
  T* operator->() { return &stored_->value; }
  const T* operator->() const { return &stored_->value; }
  const std::string& name() const { return stored_->name(); }

 private:
  std::shared_ptr<Stored> stored_;
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
  void swap_vertices(VertexHandle a, VertexHandle b) {
    for (const auto& p : vertices) p->swap(a.idx(), b.idx());
    for (const TupleList* list : {&edges, &halfedges, &faces, &halffaces})
      for (const auto& p : *list) p->exchange(a, b);
  }
  void swap_cells(CellHandle a, CellHandle b) {
    for (const auto& p : cells) p->swap(a.idx(), b.idx());
  }
  /// See TupleStored::inherit().
  void inherit(const std::array<VertexHandle, 2>& from, const std::array<VertexHandle, 2>& to) {
    for (const TupleList* list : {&edges, &halfedges})
      for (const auto& p : *list) p->inherit(from.data(), to.data());
  }
  void inherit(const std::array<VertexHandle, 3>& from, const std::array<VertexHandle, 3>& to) {
    for (const TupleList* list : {&faces, &halffaces})
      for (const auto& p : *list) p->inherit(from.data(), to.data());
  }
  /// See TupleStored::replace().
  void replace(const std::array<VertexHandle, 2>& from, const std::array<VertexHandle, 2>& to) {
    for (const TupleList* list : {&edges, &halfedges})
      for (const auto& p : *list) p->replace(from.data(), to.data());
  }
  void replace(const std::array<VertexHandle, 3>& from, const std::array<VertexHandle, 3>& to) {
    for (const TupleList* list : {&faces, &halffaces})
      for (const auto& p : *list) p->replace(from.data(), to.data());
  }
  /// Whether there are any of edges, half-edges, faces or half-faces.
  bool has_tuples() const {
    return !edges.empty() || !halfedges.empty() || !faces.empty() || !halffaces.empty();
  }
  /// Follows a renumbering, while `of` is still the mesh as it was.
  void renumber(const TetMesh& of, const std::vector<VertexHandle>& new_vertex, std::size_t n_vertices,
                const std::vector<CellHandle>& new_cell, std::size_t n_cells);
  std::size_t memory_bytes() const;
  /// The values of `saved`, of a mesh of so many vertices and cells, in the storage that handles know.
  void take(PropertySet& saved, std::size_t n_vertices, std::size_t n_cells);
};

}  // namespace hfr

#endif
