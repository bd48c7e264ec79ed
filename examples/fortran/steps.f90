! SPDX-License-Identifier: BSD-3-Clause
! A loop of time steps: a cube whose inside is turned a little more at every step, with a field that is carried over
! whatever repairs the mesh, and arrays of the solver that are brought up to date only when something has changed.
!   gfortran $(pkg-config --variable=fortran_module hfremesh_c) steps.f90 $(pkg-config --libs hfremesh_c) -o steps
program steps_of_a_cube
  use, intrinsic :: iso_c_binding
  use hfremesh
  implicit none
  integer, parameter :: n = 6, n_steps = 25
  integer, parameter :: path(3, 6) = reshape([1, 2, 3, 2, 3, 1, 3, 1, 2, 1, 3, 2, 3, 2, 1, 2, 1, 3], [3, 6])
  real(c_double), allocatable :: points(:, :), displacement(:, :), heat(:)
  integer(c_int32_t) :: cells(4, 6*n**3)
  integer(c_int32_t), allocatable :: made(:, :)
  type(hfr_mesh) :: mesh
  type(hfr_options) :: options
  type(hfr_remesher) :: remesher
  type(hfr_step) :: step
  integer :: i, n_changed
  real(c_double) :: least

  call make_cube()
  call hfr_new(mesh)
  call hfr_new(options)
  if (hfr_build(mesh, points, cells) /= HFR_OK) call fail(hfr_message(mesh))
  heat = 300 + 10*points(3, :) ! linear: it stays so
  if (hfr_set_field(mesh, 'vertices', 'heat', heat) /= HFR_OK) call fail(hfr_message(mesh))
  if (hfr_set(options, 'min_dihedral', '15') /= HFR_OK) call fail(hfr_message(options))
  if (hfr_set(options, 'trigger', '10') /= HFR_OK) call fail(hfr_message(options))
  if (hfr_set(options, 'transfer', 'heat:linear') /= HFR_OK) call fail(hfr_message(options))
  if (hfr_new_remesher(remesher, mesh, options) /= HFR_OK) call fail(hfr_message(mesh))

  n_changed = 0
  least = 180
  do i = 1, n_steps
    displacement = motion(points, 0.15d0)
    if (hfr_take_step(remesher, displacement, step) /= HFR_OK) call fail(hfr_message(remesher))
    if (step%changed /= 0) then ! else the solver keeps its matrix, its preconditioner, everything
      n_changed = n_changed + 1
      made = reshape([integer(c_int32_t) ::], [5, int(hfr_edit_count(remesher, 1, 'created_cells'))], pad=[0_c_int32_t])
      if (hfr_get_edits(remesher, 1, 'created_cells', made) /= HFR_OK) call fail(hfr_message(remesher))
      print '(a, i0, a, i0, a, i0, a)', 'step ', i, ': ', hfr_edit_count(remesher, 1, 'removed_cells'), &
        ' cells removed, ', size(made, 2), ' created'
      deallocate (points, heat)
      allocate (points(3, hfr_count(mesh, 'vertices')), heat(hfr_count(mesh, 'vertices')))
    end if
    if (hfr_get(mesh, 'points', points) /= HFR_OK) call fail(hfr_message(mesh))
    if (hfr_get_field(mesh, 'vertices', 'heat', heat) /= HFR_OK) call fail(hfr_message(mesh))
    if (any(abs(heat - 300 - 10*points(3, :)) > 1d-9)) call fail('the field is not carried over')
    if (step%inverted > 0) call fail('cells are inverted')
    least = min(least, step%min_dihedral)
  end do
  print '(i0, a, i0, a, f0.2)', n_changed, ' of ', n_steps, ' steps changed the mesh; smallest angle ', least
  if (n_changed < 2 .or. n_changed == n_steps) call fail('all steps were alike')
  displacement(2, 5) = ieee_nan()
  if (hfr_take_step(remesher, displacement, step) /= HFR_INVALID_INPUT) call fail('NaN was taken')
  call hfr_free(remesher)
  call hfr_free(options)
  call hfr_free(mesh)

contains

  ! Turns what lies near the axis; the surface stays.
  function motion(points, angle) result(d)
    real(c_double), intent(in) :: points(:, :), angle
    real(c_double) :: d(3, size(points, 2)), p(3), a
    integer :: v
    do v = 1, size(points, 2)
      p = points(:, v) - 0.5d0
      a = angle*max(0d0, 1 - 2*maxval(abs(p)))
      d(:, v) = [cos(a)*p(1) - sin(a)*p(2) - p(1), sin(a)*p(1) + cos(a)*p(2) - p(2), 0d0]
    end do
  end function

  function ieee_nan() result(x)
    use, intrinsic :: ieee_arithmetic
    real(c_double) :: x
    x = ieee_value(x, ieee_quiet_nan)
  end function

  subroutine make_cube()
    integer :: v, cube, c, s, m, at(3)
    allocate (points(3, (n + 1)**3))
    do v = 0, (n + 1)**3 - 1
      points(:, v + 1) = real([mod(v, n + 1), mod(v/(n + 1), n + 1), v/(n + 1)**2], c_double)/n
    end do
    m = 0
    do cube = 0, n**3 - 1
      do c = 1, 6
        m = m + 1
        at = [mod(cube, n), mod(cube/n, n), cube/n**2]
        do s = 1, 4
          cells(s, m) = (at(3)*(n + 1) + at(2))*(n + 1) + at(1) + 1
          if (s < 4) at(path(s, c)) = at(path(s, c)) + 1
        end do
      end do
    end do
  end subroutine

  subroutine fail(message)
    character(len=*), intent(in) :: message
    print '(a)', message
    error stop 1
  end subroutine
end program
