! SPDX-License-Identifier: BSD-3-Clause
! What the examples do not call: fields of integers, walks, the parts of a step, and a mesh that is changed between steps.
program fortran_api
  use, intrinsic :: iso_c_binding
  use hfremesh
  implicit none
  real(c_double), parameter :: corners(3, 5) = reshape([0d0, 0d0, 0d0, 1d0, 0d0, 0d0, 0d0, 1d0, 0d0, &
      0d0, 0d0, 1d0, 1d0, 1d0, 1d0], [3, 5])
  integer(c_int32_t), parameter :: two(4, 2) = reshape([1, 2, 3, 4, 2, 3, 4, 5], [4, 2])
  type(hfr_mesh) :: mesh
  type(hfr_options) :: options
  type(hfr_remesher) :: remesher
  type(hfr_step) :: step
  integer(c_int64_t) :: found(8), ids(2), ids_back(2), pairs(2, 5), pairs_back(2, 5)
  integer(c_int32_t) :: triples(3, 2), triples_back(3, 2)
  real(c_double) :: points(3, 5), none_moved(3, 5)
  integer(c_size_t) :: n

  call hfr_new(mesh)
  call hfr_new(options)
  call expect(hfr_build(mesh, corners, two) == HFR_OK, 'two cells are a mesh')

  ids = [2_c_int64_t**40, -1_c_int64_t]
  call expect(hfr_set_field(mesh, 'cells', 'id', ids) == HFR_OK, 'integers of 64 bits are set')
  call expect(hfr_get_field(mesh, 'cells', 'id', ids_back) == HFR_OK, 'and got')
  call expect(all(ids == ids_back), 'and got')
  pairs = reshape([1, 2, 3, 4, 5, 6, 7, 8, 9, 10], [2, 5])
  call expect(hfr_set_field(mesh, 'vertices', 'pair', pairs) == HFR_OK, 'rows of them are set')
  call expect(hfr_get_field(mesh, 'vertices', 'pair', pairs_back) == HFR_OK, 'and got')
  call expect(all(pairs == pairs_back), 'and got')
  triples = reshape([1, 2, 3, 4, 5, 6], [3, 2])
  call expect(hfr_set_field(mesh, 'cells', 'triple', triples) == HFR_OK, 'rows of 32 bits are set')
  call expect(hfr_get_field(mesh, 'cells', 'triple', triples_back) == HFR_OK, 'and got')
  call expect(all(triples == triples_back), 'and got')

  call expect(hfr_vertex_vertices(mesh, 1_c_int64_t, found, n) == HFR_OK, 'a corner has three neighbours')
  call expect(n == 3, 'a corner has three neighbours')
  call expect(hfr_cell_cells(mesh, 1_c_int64_t, found, n) == HFR_OK, 'a cell has one')
  call expect(n == 1 .and. found(1) == 2, 'a cell has one')

  call expect(hfr_set(options, 'min_dihedral', '40') == HFR_OK, 'a goal is an option')
  call expect(hfr_set(options, 'trigger', '30') == HFR_OK, 'a trigger is an option')
  call expect(hfr_set(options, 'ids', 'true') == HFR_OK, 'ids are an option')
  call expect(hfr_new_remesher(remesher, mesh, options) == HFR_OK, 'a remesher is made')
  call expect(hfr_get_edits(remesher, 1, 'cell_ids', ids_back) == HFR_OK, 'ids differ')
  call expect(ids_back(1) /= ids_back(2), 'ids differ')
  call expect(hfr_needs_repair(remesher) == HFR_CAUSE_NONE, 'nothing calls for a repair')
  none_moved = 0
  call expect(hfr_move(remesher, none_moved, step) == HFR_OK, 'a move of nothing')
  call expect(step%cause == HFR_CAUSE_NONE, 'a move of nothing')

  ! The first corner comes near the opposite face: only a reset tells the remesher of it.
  points = corners
  points(:, 1) = 0.3d0
  call expect(hfr_set(mesh, 'points', points) == HFR_OK, 'points are set')
  call expect(hfr_reset(remesher) == HFR_OK, 'and the remesher told')
  call expect(hfr_needs_repair(remesher) == HFR_CAUSE_ANGLE, 'a flat cell calls for a repair')
  call expect(hfr_repair(remesher, step) == HFR_OK, 'which is asked for')
  call expect(step%cause == HFR_CAUSE_ASKED, 'which is asked for')
  call expect(hfr_transfer(remesher) == HFR_OK, 'nothing is left to carry over')

  call hfr_free(remesher)
  call hfr_free(options)
  call hfr_free(mesh)

contains

  subroutine expect(holds, what)
    logical, intent(in) :: holds
    character(len=*), intent(in) :: what
    if (holds) return
    print '(3a)', what, ': ', hfr_message(mesh)
    error stop 1
  end subroutine
end program
