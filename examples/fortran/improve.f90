! SPDX-License-Identifier: BSD-3-Clause
! Arrays in, repaired arrays out: a cube of 4^3 grid cubes, six cells each, whose inner vertices a made-up simulation has
! moved too far.
!   gfortran $(pkg-config --variable=fortran_module hfremesh_c) improve.f90 $(pkg-config --libs hfremesh_c) -o improve
program improve_a_cube
  use, intrinsic :: iso_c_binding
  use hfremesh
  implicit none
  integer, parameter :: n = 4
  integer, parameter :: path(3, 6) = reshape([1, 2, 3, 2, 3, 1, 3, 1, 2, 1, 3, 2, 3, 2, 1, 2, 1, 3], [3, 6])
  real(c_double) :: points(3, (n + 1)**3)
  integer(c_int32_t) :: cells(4, 6*n**3)
  real(c_double), allocatable :: new_points(:, :)
  integer(c_int32_t), allocatable :: new_cells(:, :)
  type(hfr_mesh) :: mesh
  type(hfr_options) :: options
  type(hfr_result) :: what

  if (hfr_abi() /= HFR_ABI_VERSION) error stop 'another library than the module''s'
  call make_cube()
  call hfr_new(mesh)
  call hfr_new(options)
  if (hfr_build(mesh, points, cells) /= HFR_OK) call fail(hfr_message(mesh))
  if (hfr_set(options, 'min_dihedral', '12') /= HFR_OK) call fail(hfr_message(options))
  if (hfr_improve(mesh, options, what) /= HFR_OK) call fail(hfr_message(mesh))
  print '(a, i0, a, i0, a, f0.2, a, f0.2, a)', 'inverted: ', what%before%inverted, ' before, ', what%after%inverted, &
    ' after; smallest angle: ', what%before%min_dihedral, ' before, ', what%after%min_dihedral, ' after'

  allocate (new_points(3, hfr_count(mesh, 'vertices')), new_cells(4, hfr_count(mesh, 'cells')))
  if (hfr_get(mesh, 'points', new_points) /= HFR_OK) call fail(hfr_message(mesh))
  if (hfr_get(mesh, 'cells', new_cells) /= HFR_OK) call fail(hfr_message(mesh))
  if (minval(new_cells) /= 1 .or. maxval(new_cells) /= size(new_points, 2)) call fail('cells count from 1')
  if (what%before%inverted == 0 .or. what%goal_reached == 0) call fail('the goal was missed')

  ! What is wrong is named, and the mesh stays as it was.
  cells(3, 7) = 1000
  if (hfr_build(mesh, points, cells) /= HFR_INVALID_INPUT) call fail('a bad index was taken')
  print '(a)', hfr_message(mesh)
  if (hfr_count(mesh, 'cells') /= size(new_cells, 2)) call fail('the mesh changed')
  call hfr_free(options)
  call hfr_free(mesh)

contains

  subroutine make_cube()
    integer :: i, j, k, c, s, m, at(3)
    do k = 0, n
      do j = 0, n
        do i = 0, n
          associate (p => points(:, number([i, j, k])))
            p = real([i, j, k], c_double)/n
            if (min(i, j, k) > 0 .and. max(i, j, k) < n) p(1) = p(1) + 0.3d0*sin(9d0*j + 5d0*k)
          end associate
        end do
      end do
    end do
    m = 0
    do k = 0, n - 1
      do j = 0, n - 1
        do i = 0, n - 1
          do c = 1, 6
            m = m + 1
            at = [i, j, k]
            cells(1, m) = number(at)
            do s = 1, 3
              at(path(s, c)) = at(path(s, c)) + 1
              cells(s + 1, m) = number(at)
            end do
          end do
        end do
      end do
    end do
  end subroutine

  integer function number(at)
    integer, intent(in) :: at(3)
    number = (at(3)*(n + 1) + at(2))*(n + 1) + at(1) + 1
  end function

  subroutine fail(message)
    character(len=*), intent(in) :: message
    print '(a)', message
    error stop 1
  end subroutine
end program
