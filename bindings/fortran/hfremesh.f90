! SPDX-License-Identifier: BSD-3-Clause
! HFRemesh for Fortran 2008: the functions of hfremesh.h, with Fortran's strings and arrays; not here are
! hfr_options_on_transfer(), hfr_options_name() and hfr_version(). Compile this file with the
! program and link libhfremesh_c. docs/c-api.md tells the story.
!
! Arrays are (components, items), so that an item lies in one piece: points(3, n), cells(4, m). Vertices and cells count
! from 1. What can fail returns HFR_OK or what went wrong; hfr_message() has the line about it.
module hfremesh
  use, intrinsic :: iso_c_binding
  implicit none
  private

  integer(c_int), parameter, public :: HFR_ABI_VERSION = 1
  integer(c_int), parameter, public :: HFR_OK = 0, HFR_INVALID_INPUT = 1, HFR_IO_ERROR = 2, HFR_DEVICE_ERROR = 3, &
      HFR_RESOURCE_LIMIT = 4, HFR_INTERNAL_ERROR = 5
  integer(c_int32_t), parameter, public :: HFR_STOP_GOAL = 0, HFR_STOP_NO_PROGRESS = 1, HFR_STOP_ITERATIONS = 2, &
      HFR_STOP_TIME_LIMIT = 3, HFR_STOP_CANCELLED = 4, HFR_STOP_DEVICE_LOST = 5
  integer(c_int32_t), parameter, public :: HFR_CAUSE_NONE = 0, HFR_CAUSE_INVERTED = 1, HFR_CAUSE_ANGLE = 2, &
      HFR_CAUSE_METRIC = 3, HFR_CAUSE_JACOBIAN = 4, HFR_CAUSE_INDICATOR = 5, HFR_CAUSE_MOTION = 6, &
      HFR_CAUSE_STEPS = 7, HFR_CAUSE_ASKED = 8
  integer(c_int32_t), parameter :: kInt32 = 1, kInt64 = 2, kFloat64 = 4

  type, bind(c) :: c_array
    type(c_ptr) :: data
    integer(c_int64_t) :: rows
    integer(c_int32_t) :: columns
    integer(c_int32_t) :: type
    integer(c_int64_t) :: row_stride
  end type

  type, bind(c), public :: hfr_statistics
    integer(c_int64_t) :: vertices, cells, boundary_faces, components, inverted, flat
    integer(c_int64_t) :: worst_cell
    real(c_double) :: min_dihedral, mean_dihedral, max_dihedral
    real(c_double) :: min_quality, mean_quality
    real(c_double) :: volume, absolute_volume, overlap
    real(c_double) :: min_edge, mean_edge, max_edge
    real(c_double) :: surface_ceiling
    real(c_double) :: reserved(8)
  end type

  type, bind(c), public :: hfr_result
    integer(c_int32_t) :: changed, goal_reached, stop, padding
    integer(c_int64_t) :: invalid_cells
    real(c_double) :: seconds
    type(hfr_statistics) :: before, after
  end type

  type, bind(c), public :: hfr_progress
    type(c_ptr) :: stage
    integer(c_int32_t) :: iteration
    real(c_double) :: fraction
    integer(c_int64_t) :: inverted
    real(c_double) :: min_dihedral
  end type

  type, bind(c), public :: hfr_step
    integer(c_int32_t) :: changed, cause, stop, undone
    integer(c_int64_t) :: repairs, looked_at, refused, inverted
    real(c_double) :: fraction, min_dihedral
  end type

  ! Handles; made by hfr_new(), freed by hfr_free().
  type, public :: hfr_mesh
    private
    type(c_ptr) :: handle = c_null_ptr
  end type
  type, public :: hfr_options
    private
    type(c_ptr) :: handle = c_null_ptr
  end type

  type, public :: hfr_remesher
    private
    type(c_ptr) :: handle = c_null_ptr
  end type

  abstract interface
    subroutine hfr_progress_callback(now, user) bind(c)
      import :: hfr_progress, c_ptr
      type(hfr_progress), intent(in) :: now
      type(c_ptr), value :: user
    end subroutine
    ! Anything but 0 ends the run with the best mesh so far.
    function hfr_cancel_callback(user) bind(c) result(wanted)
      import :: c_ptr, c_int
      type(c_ptr), value :: user
      integer(c_int) :: wanted
    end function
  end interface
  public :: hfr_progress_callback, hfr_cancel_callback

  interface hfr_new
    module procedure new_mesh, new_options
  end interface
  interface hfr_free
    module procedure free_mesh, free_options, free_remesher
  end interface
  ! The line about the last call with this handle that failed.
  interface hfr_message
    module procedure mesh_message, options_message, remesher_message
  end interface
  ! hfr_set(mesh, 'points', points), hfr_set(mesh, 'regions', regions), hfr_set(options, 'min_dihedral', '20').
  interface hfr_set
    module procedure set_option, set_real_rows, set_int_rows, set_int_items
  end interface
  ! hfr_get(mesh, 'points', points), hfr_get(mesh, 'cells', cells), hfr_get(mesh, 'regions', regions).
  interface hfr_get
    module procedure get_real_rows, get_int_rows, get_int_items
  end interface
  ! hfr_get_edits(remesher, repair, 'created_cells', cells): see hfr_remesher_get() in hfremesh.h; repair from 1.
  interface hfr_get_edits
    module procedure get_int_edits, get_int_rows_edits, get_real_rows_edits, get_long_edits
  end interface
  interface hfr_set_field
    module procedure set_real_field, set_real_rows_field, set_int_field, set_int_rows_field, set_long_field, &
        set_long_rows_field
  end interface
  interface hfr_get_field
    module procedure get_real_field, get_real_rows_field, get_int_field, get_int_rows_field, get_long_field, &
        get_long_rows_field
  end interface
  public :: hfr_new, hfr_free, hfr_message, hfr_set, hfr_get, hfr_set_field, hfr_get_field, hfr_abi, hfr_build, hfr_read, &
      hfr_write, hfr_count, hfr_stats, hfr_quality, hfr_check, hfr_improve, hfr_on_progress, hfr_on_cancel, &
      hfr_vertex_cells, hfr_vertex_vertices, hfr_edge_cells, hfr_cell_cells, hfr_new_remesher, hfr_take_step, hfr_move, &
      hfr_repair, hfr_transfer, hfr_needs_repair, hfr_reset, hfr_edit_count, hfr_get_edits

  interface
    function c_abi() bind(c, name='hfr_abi_version') result(n)
      import
      integer(c_int) :: n
    end function
    function c_mesh_new(base) bind(c, name='hfr_mesh_new') result(handle)
      import
      integer(c_int), value :: base
      type(c_ptr) :: handle
    end function
    subroutine c_mesh_free(handle) bind(c, name='hfr_mesh_free')
      import
      type(c_ptr), value :: handle
    end subroutine
    function c_options_new() bind(c, name='hfr_options_new') result(handle)
      import
      type(c_ptr) :: handle
    end function
    subroutine c_options_free(handle) bind(c, name='hfr_options_free')
      import
      type(c_ptr), value :: handle
    end subroutine
    function c_mesh_message(handle) bind(c, name='hfr_mesh_message') result(text)
      import
      type(c_ptr), value :: handle
      type(c_ptr) :: text
    end function
    function c_options_message(handle) bind(c, name='hfr_options_message') result(text)
      import
      type(c_ptr), value :: handle
      type(c_ptr) :: text
    end function
    function c_options_set(handle, name, value) bind(c, name='hfr_options_set') result(status)
      import
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: name(*), value(*)
      integer(c_int) :: status
    end function
    function c_on_progress(handle, call, user) bind(c, name='hfr_options_on_progress') result(status)
      import
      type(c_ptr), value :: handle, user
      type(c_funptr), value :: call
      integer(c_int) :: status
    end function
    function c_on_cancel(handle, ask, user) bind(c, name='hfr_options_on_cancel') result(status)
      import
      type(c_ptr), value :: handle, user
      type(c_funptr), value :: ask
      integer(c_int) :: status
    end function
    function c_build(handle, points, cells) bind(c, name='hfr_mesh_build') result(status)
      import
      type(c_ptr), value :: handle
      type(c_array), intent(in) :: points, cells
      integer(c_int) :: status
    end function
    function c_read(handle, path) bind(c, name='hfr_mesh_read') result(status)
      import
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: path(*)
      integer(c_int) :: status
    end function
    function c_write(handle, path, variant) bind(c, name='hfr_mesh_write') result(status)
      import
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: path(*), variant(*)
      integer(c_int) :: status
    end function
    function c_count(handle, what) bind(c, name='hfr_mesh_count') result(n)
      import
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: what(*)
      integer(c_int64_t) :: n
    end function
    function c_set(handle, what, values) bind(c, name='hfr_mesh_set') result(status)
      import
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: what(*)
      type(c_array), intent(in) :: values
      integer(c_int) :: status
    end function
    function c_get(handle, what, values) bind(c, name='hfr_mesh_get') result(status)
      import
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: what(*)
      type(c_array), intent(in) :: values
      integer(c_int) :: status
    end function
    function c_set_field(handle, of, name, values) bind(c, name='hfr_mesh_set_field') result(status)
      import
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: of(*), name(*)
      type(c_array), intent(in) :: values
      integer(c_int) :: status
    end function
    function c_get_field(handle, of, name, values) bind(c, name='hfr_mesh_get_field') result(status)
      import
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: of(*), name(*)
      type(c_array), intent(in) :: values
      integer(c_int) :: status
    end function
    function c_stats(handle, threads, figures) bind(c, name='hfr_mesh_statistics') result(status)
      import
      type(c_ptr), value :: handle
      integer(c_int), value :: threads
      type(hfr_statistics), intent(out) :: figures
      integer(c_int) :: status
    end function
    function c_quality(handle, metric, values) bind(c, name='hfr_mesh_quality') result(status)
      import
      type(c_ptr), value :: handle
      character(kind=c_char), intent(in) :: metric(*)
      type(c_array), intent(in) :: values
      integer(c_int) :: status
    end function
    function c_check(handle) bind(c, name='hfr_mesh_check') result(status)
      import
      type(c_ptr), value :: handle
      integer(c_int) :: status
    end function
    function c_improve(handle, options, what) bind(c, name='hfr_improve') result(status)
      import
      type(c_ptr), value :: handle, options
      type(hfr_result), intent(out) :: what
      integer(c_int) :: status
    end function
    function c_vertex_cells(handle, vertex, out, capacity, n) bind(c, name='hfr_vertex_cells') result(status)
      import
      type(c_ptr), value :: handle
      integer(c_int64_t), value :: vertex
      integer(c_int64_t), intent(out) :: out(*)
      integer(c_size_t), value :: capacity
      integer(c_size_t), intent(out) :: n
      integer(c_int) :: status
    end function
    function c_vertex_vertices(handle, vertex, out, capacity, n) bind(c, name='hfr_vertex_vertices') result(status)
      import
      type(c_ptr), value :: handle
      integer(c_int64_t), value :: vertex
      integer(c_int64_t), intent(out) :: out(*)
      integer(c_size_t), value :: capacity
      integer(c_size_t), intent(out) :: n
      integer(c_int) :: status
    end function
    function c_cell_cells(handle, cell, out, capacity, n) bind(c, name='hfr_cell_cells') result(status)
      import
      type(c_ptr), value :: handle
      integer(c_int64_t), value :: cell
      integer(c_int64_t), intent(out) :: out(*)
      integer(c_size_t), value :: capacity
      integer(c_size_t), intent(out) :: n
      integer(c_int) :: status
    end function
    function c_edge_cells(handle, a, b, out, capacity, n) bind(c, name='hfr_edge_cells') result(status)
      import
      type(c_ptr), value :: handle
      integer(c_int64_t), value :: a, b
      integer(c_int64_t), intent(out) :: out(*)
      integer(c_size_t), value :: capacity
      integer(c_size_t), intent(out) :: n
      integer(c_int) :: status
    end function
    function c_remesher_new(mesh, options, out) bind(c, name='hfr_remesher_new') result(status)
      import
      type(c_ptr), value :: mesh, options
      type(c_ptr), intent(out) :: out
      integer(c_int) :: status
    end function
    subroutine c_remesher_free(handle) bind(c, name='hfr_remesher_free')
      import
      type(c_ptr), value :: handle
    end subroutine
    function c_remesher_message(handle) bind(c, name='hfr_remesher_message') result(text)
      import
      type(c_ptr), value :: handle
      type(c_ptr) :: text
    end function
    function c_step(handle, displacement, what) bind(c, name='hfr_remesher_step') result(status)
      import
      type(c_ptr), value :: handle
      type(c_array), intent(in) :: displacement
      type(hfr_step), intent(out) :: what
      integer(c_int) :: status
    end function
    function c_move(handle, displacement, what) bind(c, name='hfr_remesher_move') result(status)
      import
      type(c_ptr), value :: handle
      type(c_array), intent(in) :: displacement
      type(hfr_step), intent(out) :: what
      integer(c_int) :: status
    end function
    function c_repair(handle, what) bind(c, name='hfr_remesher_repair') result(status)
      import
      type(c_ptr), value :: handle
      type(hfr_step), intent(out) :: what
      integer(c_int) :: status
    end function
    function c_transfer(handle) bind(c, name='hfr_remesher_transfer') result(status)
      import
      type(c_ptr), value :: handle
      integer(c_int) :: status
    end function
    function c_needs_repair(handle) bind(c, name='hfr_remesher_needs_repair') result(cause)
      import
      type(c_ptr), value :: handle
      integer(c_int) :: cause
    end function
    function c_reset(handle) bind(c, name='hfr_remesher_reset') result(status)
      import
      type(c_ptr), value :: handle
      integer(c_int) :: status
    end function
    function c_edit_count(handle, repair, what) bind(c, name='hfr_remesher_count') result(n)
      import
      type(c_ptr), value :: handle
      integer(c_int64_t), value :: repair
      character(kind=c_char), intent(in) :: what(*)
      integer(c_int64_t) :: n
    end function
    function c_get_edits(handle, repair, what, values) bind(c, name='hfr_remesher_get') result(status)
      import
      type(c_ptr), value :: handle
      integer(c_int64_t), value :: repair
      character(kind=c_char), intent(in) :: what(*)
      type(c_array), intent(in) :: values
      integer(c_int) :: status
    end function
    function c_strlen(text) bind(c, name='strlen') result(n)
      import
      type(c_ptr), value :: text
      integer(c_size_t) :: n
    end function
  end interface

contains

  ! --- the library ---

  ! HFR_ABI_VERSION of the library that is linked.
  function hfr_abi() result(n)
    integer(c_int) :: n
    n = c_abi()
  end function

  subroutine new_mesh(mesh)
    type(hfr_mesh), intent(out) :: mesh
    mesh%handle = c_mesh_new(1_c_int)
  end subroutine

  subroutine free_mesh(mesh)
    type(hfr_mesh), intent(inout) :: mesh
    call c_mesh_free(mesh%handle)
    mesh%handle = c_null_ptr
  end subroutine

  subroutine new_options(options)
    type(hfr_options), intent(out) :: options
    options%handle = c_options_new()
  end subroutine

  subroutine free_options(options)
    type(hfr_options), intent(inout) :: options
    call c_options_free(options%handle)
    options%handle = c_null_ptr
  end subroutine

  function mesh_message(mesh) result(text)
    type(hfr_mesh), intent(in) :: mesh
    character(len=:), allocatable :: text
    text = from_c(c_mesh_message(mesh%handle))
  end function

  function options_message(options) result(text)
    type(hfr_options), intent(in) :: options
    character(len=:), allocatable :: text
    text = from_c(c_options_message(options%handle))
  end function

  ! --- options ---

  function set_option(options, name, value) result(status)
    type(hfr_options), intent(in) :: options
    character(len=*), intent(in) :: name, value
    integer(c_int) :: status
    status = c_options_set(options%handle, to_c(name), to_c(value))
  end function

  ! A subroutine of the interface hfr_progress_callback. It is kept: it must not be internal to a procedure that ends.
  function hfr_on_progress(options, call, user) result(status)
    type(hfr_options), intent(in) :: options
    procedure(hfr_progress_callback) :: call
    type(c_ptr), intent(in) :: user
    integer(c_int) :: status
    status = c_on_progress(options%handle, c_funloc(call), user)
  end function

  function hfr_on_cancel(options, ask, user) result(status)
    type(hfr_options), intent(in) :: options
    procedure(hfr_cancel_callback) :: ask
    type(c_ptr), intent(in) :: user
    integer(c_int) :: status
    status = c_on_cancel(options%handle, c_funloc(ask), user)
  end function

  ! --- a mesh ---

  ! points(3, n), cells(4, m) with vertices from 1 to n.
  function hfr_build(mesh, points, cells) result(status)
    type(hfr_mesh), intent(in) :: mesh
    real(c_double), intent(in), target, contiguous :: points(:, :)
    integer(c_int32_t), intent(in), target, contiguous :: cells(:, :)
    integer(c_int) :: status
    status = c_build(mesh%handle, real_rows(points), int_rows(cells))
  end function

  function hfr_read(mesh, path) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: path
    integer(c_int) :: status
    status = c_read(mesh%handle, to_c(path))
  end function

  ! variant: '', 'binary', or a version or encoding of the format.
  function hfr_write(mesh, path, variant) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: path, variant
    integer(c_int) :: status
    status = c_write(mesh%handle, to_c(path), to_c(variant))
  end function

  ! Of 'vertices', 'cells', 'edges', ...; -1 for another word.
  function hfr_count(mesh, what) result(n)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: what
    integer(c_int64_t) :: n
    n = c_count(mesh%handle, to_c(what))
  end function

  function set_real_rows(mesh, what, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: what
    real(c_double), intent(in), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_set(mesh%handle, to_c(what), real_rows(values))
  end function

  function set_int_rows(mesh, what, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: what
    integer(c_int32_t), intent(in), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_set(mesh%handle, to_c(what), int_rows(values))
  end function

  function set_int_items(mesh, what, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: what
    integer(c_int32_t), intent(in), target, contiguous :: values(:)
    integer(c_int) :: status
    status = c_set(mesh%handle, to_c(what), int_items(values))
  end function

  function get_real_rows(mesh, what, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: what
    real(c_double), intent(inout), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_get(mesh%handle, to_c(what), real_rows(values))
  end function

  function get_int_rows(mesh, what, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: what
    integer(c_int32_t), intent(inout), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_get(mesh%handle, to_c(what), int_rows(values))
  end function

  function get_int_items(mesh, what, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: what
    integer(c_int32_t), intent(inout), target, contiguous :: values(:)
    integer(c_int) :: status
    status = c_get(mesh%handle, to_c(what), int_items(values))
  end function

  ! Of 'vertices' or 'cells': values(n), or values(components, n).
  function set_real_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    real(c_double), intent(in), target, contiguous :: values(:)
    integer(c_int) :: status
    status = c_set_field(mesh%handle, to_c(of), to_c(name), real_items(values))
  end function

  function set_real_rows_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    real(c_double), intent(in), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_set_field(mesh%handle, to_c(of), to_c(name), real_rows(values))
  end function

  function set_int_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    integer(c_int32_t), intent(in), target, contiguous :: values(:)
    integer(c_int) :: status
    status = c_set_field(mesh%handle, to_c(of), to_c(name), int_items(values))
  end function

  function get_real_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    real(c_double), intent(inout), target, contiguous :: values(:)
    integer(c_int) :: status
    status = c_get_field(mesh%handle, to_c(of), to_c(name), real_items(values))
  end function

  function get_real_rows_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    real(c_double), intent(inout), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_get_field(mesh%handle, to_c(of), to_c(name), real_rows(values))
  end function

  function get_int_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    integer(c_int32_t), intent(inout), target, contiguous :: values(:)
    integer(c_int) :: status
    status = c_get_field(mesh%handle, to_c(of), to_c(name), int_items(values))
  end function

  function set_int_rows_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    integer(c_int32_t), intent(in), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_set_field(mesh%handle, to_c(of), to_c(name), int_rows(values))
  end function

  function set_long_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    integer(c_int64_t), intent(in), target, contiguous :: values(:)
    integer(c_int) :: status
    status = c_set_field(mesh%handle, to_c(of), to_c(name), long_items(values))
  end function

  function set_long_rows_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    integer(c_int64_t), intent(in), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_set_field(mesh%handle, to_c(of), to_c(name), long_rows(values))
  end function

  function get_int_rows_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    integer(c_int32_t), intent(inout), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_get_field(mesh%handle, to_c(of), to_c(name), int_rows(values))
  end function

  function get_long_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    integer(c_int64_t), intent(inout), target, contiguous :: values(:)
    integer(c_int) :: status
    status = c_get_field(mesh%handle, to_c(of), to_c(name), long_items(values))
  end function

  function get_long_rows_field(mesh, of, name, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: of, name
    integer(c_int64_t), intent(inout), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_get_field(mesh%handle, to_c(of), to_c(name), long_rows(values))
  end function

  ! Up to size(cells) of the n cells round the vertex.
  function hfr_vertex_cells(mesh, vertex, cells, n) result(status)
    type(hfr_mesh), intent(in) :: mesh
    integer(c_int64_t), intent(in) :: vertex
    integer(c_int64_t), intent(inout), contiguous :: cells(:)
    integer(c_size_t), intent(out) :: n
    integer(c_int) :: status
    status = c_vertex_cells(mesh%handle, vertex, cells, size(cells, kind=c_size_t), n)
  end function

  function hfr_vertex_vertices(mesh, vertex, vertices, n) result(status)
    type(hfr_mesh), intent(in) :: mesh
    integer(c_int64_t), intent(in) :: vertex
    integer(c_int64_t), intent(inout), contiguous :: vertices(:)
    integer(c_size_t), intent(out) :: n
    integer(c_int) :: status
    status = c_vertex_vertices(mesh%handle, vertex, vertices, size(vertices, kind=c_size_t), n)
  end function

  ! Those behind its faces.
  function hfr_cell_cells(mesh, cell, cells, n) result(status)
    type(hfr_mesh), intent(in) :: mesh
    integer(c_int64_t), intent(in) :: cell
    integer(c_int64_t), intent(inout), contiguous :: cells(:)
    integer(c_size_t), intent(out) :: n
    integer(c_int) :: status
    status = c_cell_cells(mesh%handle, cell, cells, size(cells, kind=c_size_t), n)
  end function

  function hfr_edge_cells(mesh, a, b, cells, n) result(status)
    type(hfr_mesh), intent(in) :: mesh
    integer(c_int64_t), intent(in) :: a, b
    integer(c_int64_t), intent(inout), contiguous :: cells(:)
    integer(c_size_t), intent(out) :: n
    integer(c_int) :: status
    status = c_edge_cells(mesh%handle, a, b, cells, size(cells, kind=c_size_t), n)
  end function

  ! --- measuring, and a run ---

  function hfr_stats(mesh, figures) result(status)
    type(hfr_mesh), intent(in) :: mesh
    type(hfr_statistics), intent(out) :: figures
    integer(c_int) :: status
    status = c_stats(mesh%handle, 0_c_int, figures)
  end function

  function hfr_quality(mesh, metric, values) result(status)
    type(hfr_mesh), intent(in) :: mesh
    character(len=*), intent(in) :: metric
    real(c_double), intent(inout), target, contiguous :: values(:)
    integer(c_int) :: status
    status = c_quality(mesh%handle, to_c(metric), real_items(values))
  end function

  function hfr_check(mesh) result(status)
    type(hfr_mesh), intent(in) :: mesh
    integer(c_int) :: status
    status = c_check(mesh%handle)
  end function

  ! In place; however it ends, the mesh is no worse than it was.
  function hfr_improve(mesh, options, what) result(status)
    type(hfr_mesh), intent(in) :: mesh
    type(hfr_options), intent(in) :: options
    type(hfr_result), intent(out) :: what
    integer(c_int) :: status
    status = c_improve(mesh%handle, options%handle, what)
  end function

  ! --- a mesh inside of a simulation ---

  ! Of a mesh that outlives it. The message of a failure is the mesh's.
  function hfr_new_remesher(remesher, mesh, options) result(status)
    type(hfr_remesher), intent(out) :: remesher
    type(hfr_mesh), intent(in) :: mesh
    type(hfr_options), intent(in) :: options
    integer(c_int) :: status
    status = c_remesher_new(mesh%handle, options%handle, remesher%handle)
  end function

  subroutine free_remesher(remesher)
    type(hfr_remesher), intent(inout) :: remesher
    call c_remesher_free(remesher%handle)
    remesher%handle = c_null_ptr
  end subroutine

  function remesher_message(remesher) result(text)
    type(hfr_remesher), intent(in) :: remesher
    character(len=:), allocatable :: text
    text = from_c(c_remesher_message(remesher%handle))
  end function

  ! displacement(3, n): moves, looks, repairs and carries fields over.
  function hfr_take_step(remesher, displacement, what) result(status)
    type(hfr_remesher), intent(in) :: remesher
    real(c_double), intent(in), target, contiguous :: displacement(:, :)
    type(hfr_step), intent(out) :: what
    integer(c_int) :: status
    status = c_step(remesher%handle, real_rows(displacement), what)
  end function

  ! The parts of a step alone. displacement(3, n).
  function hfr_move(remesher, displacement, what) result(status)
    type(hfr_remesher), intent(in) :: remesher
    real(c_double), intent(in), target, contiguous :: displacement(:, :)
    type(hfr_step), intent(out) :: what
    integer(c_int) :: status
    status = c_move(remesher%handle, real_rows(displacement), what)
  end function

  function hfr_repair(remesher, what) result(status)
    type(hfr_remesher), intent(in) :: remesher
    type(hfr_step), intent(out) :: what
    integer(c_int) :: status
    status = c_repair(remesher%handle, what)
  end function

  function hfr_transfer(remesher) result(status)
    type(hfr_remesher), intent(in) :: remesher
    integer(c_int) :: status
    status = c_transfer(remesher%handle)
  end function

  ! HFR_CAUSE_NONE, or why the mesh is to be repaired now.
  function hfr_needs_repair(remesher) result(cause)
    type(hfr_remesher), intent(in) :: remesher
    integer(c_int) :: cause
    cause = c_needs_repair(remesher%handle)
  end function

  ! For whoever has changed the mesh between steps, by hfr_set(mesh, 'points', points) or hfr_improve().
  function hfr_reset(remesher) result(status)
    type(hfr_remesher), intent(in) :: remesher
    integer(c_int) :: status
    status = c_reset(remesher%handle)
  end function

  function hfr_edit_count(remesher, repair, what) result(n)
    type(hfr_remesher), intent(in) :: remesher
    integer, intent(in) :: repair
    character(len=*), intent(in) :: what
    integer(c_int64_t) :: n
    n = c_edit_count(remesher%handle, int(repair - 1, c_int64_t), to_c(what))
  end function

  function get_int_edits(remesher, repair, what, values) result(status)
    type(hfr_remesher), intent(in) :: remesher
    integer, intent(in) :: repair
    character(len=*), intent(in) :: what
    integer(c_int32_t), intent(inout), target, contiguous :: values(:)
    integer(c_int) :: status
    status = c_get_edits(remesher%handle, int(repair - 1, c_int64_t), to_c(what), int_items(values))
  end function

  ! 'vertex_ids' and 'cell_ids' go beyond 32 bits in the end.
  function get_long_edits(remesher, repair, what, values) result(status)
    type(hfr_remesher), intent(in) :: remesher
    integer, intent(in) :: repair
    character(len=*), intent(in) :: what
    integer(c_int64_t), intent(inout), target, contiguous :: values(:)
    integer(c_int) :: status
    status = c_get_edits(remesher%handle, int(repair - 1, c_int64_t), to_c(what), long_items(values))
  end function

  function get_int_rows_edits(remesher, repair, what, values) result(status)
    type(hfr_remesher), intent(in) :: remesher
    integer, intent(in) :: repair
    character(len=*), intent(in) :: what
    integer(c_int32_t), intent(inout), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_get_edits(remesher%handle, int(repair - 1, c_int64_t), to_c(what), int_rows(values))
  end function

  function get_real_rows_edits(remesher, repair, what, values) result(status)
    type(hfr_remesher), intent(in) :: remesher
    integer, intent(in) :: repair
    character(len=*), intent(in) :: what
    real(c_double), intent(inout), target, contiguous :: values(:, :)
    integer(c_int) :: status
    status = c_get_edits(remesher%handle, int(repair - 1, c_int64_t), to_c(what), real_rows(values))
  end function

  ! --- between the languages ---

  pure function to_c(text) result(chars)
    character(len=*), intent(in) :: text
    character(kind=c_char) :: chars(len_trim(text) + 1)
    integer :: i
    do i = 1, len_trim(text)
      chars(i) = text(i:i)
    end do
    chars(len_trim(text) + 1) = c_null_char
  end function

  function from_c(text) result(line)
    type(c_ptr), intent(in) :: text
    character(len=:), allocatable :: line
    character(kind=c_char), pointer :: chars(:)
    integer :: i
    call c_f_pointer(text, chars, [c_strlen(text)])
    allocate (character(len=size(chars)) :: line)
    do i = 1, size(chars)
      line(i:i) = chars(i)
    end do
  end function

  function described(data, rows, columns, kind) result(array)
    type(c_ptr), intent(in) :: data
    integer, intent(in) :: rows, columns
    integer(c_int32_t), intent(in) :: kind
    type(c_array) :: array
    array = c_array(data, int(rows, c_int64_t), int(columns, c_int32_t), kind, 0_c_int64_t)
  end function

  ! A zero-sized array has no address.
  function real_rows(values) result(array)
    real(c_double), intent(in), target, contiguous :: values(:, :)
    type(c_array) :: array
    type(c_ptr) :: data
    data = c_null_ptr
    if (size(values) > 0) data = c_loc(values)
    array = described(data, size(values, 2), size(values, 1), kFloat64)
  end function

  function int_rows(values) result(array)
    integer(c_int32_t), intent(in), target, contiguous :: values(:, :)
    type(c_array) :: array
    type(c_ptr) :: data
    data = c_null_ptr
    if (size(values) > 0) data = c_loc(values)
    array = described(data, size(values, 2), size(values, 1), kInt32)
  end function

  function long_rows(values) result(array)
    integer(c_int64_t), intent(in), target, contiguous :: values(:, :)
    type(c_array) :: array
    type(c_ptr) :: data
    data = c_null_ptr
    if (size(values) > 0) data = c_loc(values)
    array = described(data, size(values, 2), size(values, 1), kInt64)
  end function

  function long_items(values) result(array)
    integer(c_int64_t), intent(in), target, contiguous :: values(:)
    type(c_array) :: array
    type(c_ptr) :: data
    data = c_null_ptr
    if (size(values) > 0) data = c_loc(values)
    array = described(data, size(values), 1, kInt64)
  end function

  function real_items(values) result(array)
    real(c_double), intent(in), target, contiguous :: values(:)
    type(c_array) :: array
    type(c_ptr) :: data
    data = c_null_ptr
    if (size(values) > 0) data = c_loc(values)
    array = described(data, size(values), 1, kFloat64)
  end function

  function int_items(values) result(array)
    integer(c_int32_t), intent(in), target, contiguous :: values(:)
    type(c_array) :: array
    type(c_ptr) :: data
    data = c_null_ptr
    if (size(values) > 0) data = c_loc(values)
    array = described(data, size(values), 1, kInt32)
  end function
end module
