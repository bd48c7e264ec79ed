// SPDX-License-Identifier: BSD-3-Clause
#ifndef HFR_HALFFACE_PROPERTY_ACCESS_HH
#define HFR_HALFFACE_PROPERTY_ACCESS_HH

#include <optional>
#include <string_view>

#include "hfremesh/HalfFace/Properties.hh"

namespace hfr {

/// Properties of a mesh by name, a part of TetMesh.
///  - request_…_property<T>(name, default): the property of that name, made where there is none. Another type
///    under the name throws InvalidInput. Without a name it makes one that nobody else finds: it follows the
///    mesh as any other while a handle to it lives; no file has it, nor a copy of the mesh for long.
///  - get_…_property<T>(name): the property of that name, or nothing where there is none; never makes one. Of
///    a const mesh it is read-only: a VertexProperty<const T> and so on.
template <class Mesh>
class PropertyAccess {
 public:
  template <class T>
  VertexProperty<T> request_vertex_property(std::string_view name = {}, const T& default_value = T()) {
    return VertexProperty<T>(
        PropertySet::request_dense<T>(set().vertices, name, default_value, mesh().n_vertices()));
  }
  template <class T>
  CellProperty<T> request_cell_property(std::string_view name = {}, const T& default_value = T()) {
    return CellProperty<T>(PropertySet::request_dense<T>(set().cells, name, default_value, mesh().n_cells()));
  }
  template <class T>
  EdgeProperty<T> request_edge_property(std::string_view name = {}, const T& default_value = T()) {
    return EdgeProperty<T>(PropertySet::request_tuples<2, T, AnyOrder>(set().edges, name, default_value));
  }
  template <class T>
  HalfEdgeProperty<T> request_halfedge_property(std::string_view name = {}, const T& default_value = T()) {
    return HalfEdgeProperty<T>(
        PropertySet::request_tuples<2, T, CyclicOrder>(set().halfedges, name, default_value));
  }
  template <class T>
  FaceProperty<T> request_face_property(std::string_view name = {}, const T& default_value = T()) {
    return FaceProperty<T>(PropertySet::request_tuples<3, T, AnyOrder>(set().faces, name, default_value));
  }
  template <class T>
  HalfFaceProperty<T> request_halfface_property(std::string_view name = {}, const T& default_value = T()) {
    return HalfFaceProperty<T>(
        PropertySet::request_tuples<3, T, CyclicOrder>(set().halffaces, name, default_value));
  }
  template <class T>
  MeshProperty<T> request_mesh_property(std::string_view name = {}, const T& default_value = T()) {
    return MeshProperty<T>(PropertySet::request_single<T>(set().mesh, name, default_value));
  }

  template <class T>
  std::optional<VertexProperty<T>> get_vertex_property(std::string_view name) {
    return found<VertexProperty<T>>(set().vertices, name);
  }
  template <class T>
  std::optional<VertexProperty<const T>> get_vertex_property(std::string_view name) const {
    return found<VertexProperty<const T>>(set().vertices, name);
  }
  template <class T>
  std::optional<CellProperty<T>> get_cell_property(std::string_view name) {
    return found<CellProperty<T>>(set().cells, name);
  }
  template <class T>
  std::optional<CellProperty<const T>> get_cell_property(std::string_view name) const {
    return found<CellProperty<const T>>(set().cells, name);
  }
  template <class T>
  std::optional<EdgeProperty<T>> get_edge_property(std::string_view name) {
    return found<EdgeProperty<T>>(set().edges, name);
  }
  template <class T>
  std::optional<EdgeProperty<const T>> get_edge_property(std::string_view name) const {
    return found<EdgeProperty<const T>>(set().edges, name);
  }
  template <class T>
  std::optional<HalfEdgeProperty<T>> get_halfedge_property(std::string_view name) {
    return found<HalfEdgeProperty<T>>(set().halfedges, name);
  }
  template <class T>
  std::optional<HalfEdgeProperty<const T>> get_halfedge_property(std::string_view name) const {
    return found<HalfEdgeProperty<const T>>(set().halfedges, name);
  }
  template <class T>
  std::optional<FaceProperty<T>> get_face_property(std::string_view name) {
    return found<FaceProperty<T>>(set().faces, name);
  }
  template <class T>
  std::optional<FaceProperty<const T>> get_face_property(std::string_view name) const {
    return found<FaceProperty<const T>>(set().faces, name);
  }
  template <class T>
  std::optional<HalfFaceProperty<T>> get_halfface_property(std::string_view name) {
    return found<HalfFaceProperty<T>>(set().halffaces, name);
  }
  template <class T>
  std::optional<HalfFaceProperty<const T>> get_halfface_property(std::string_view name) const {
    return found<HalfFaceProperty<const T>>(set().halffaces, name);
  }
  template <class T>
  std::optional<MeshProperty<T>> get_mesh_property(std::string_view name) {
    return found<MeshProperty<T>>(set().mesh, name);
  }
  template <class T>
  std::optional<MeshProperty<const T>> get_mesh_property(std::string_view name) const {
    return found<MeshProperty<const T>>(set().mesh, name);
  }

 private:
  template <class Property, class List>
  static std::optional<Property> found(List& list, std::string_view name) {
    using Stored = typename Property::Stored;
    auto stored = list.template find<Stored>(name, typeid(typename Property::Value));
    if (!stored) return std::nullopt;
    return Property(std::move(stored));
  }
  Mesh& mesh() { return static_cast<Mesh&>(*this); }
  const Mesh& mesh() const { return static_cast<const Mesh&>(*this); }
  PropertySet& set() { return mesh().properties(); }
  const PropertySet& set() const { return mesh().properties(); }
};

}  // namespace hfr

#endif
