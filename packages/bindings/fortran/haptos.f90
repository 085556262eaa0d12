! SPDX-License-Identifier: BSD-3-Clause
!> Haptos from Fortran 2003: the functions of haptos.h, whose comments hold here, but for haptos_create_serial, which is for
!> callers without MPI.  Numbers of interfaces, pairs, rows and columns are C's (from 0); arrays are those of C by columns:
!> coordinates(3, nodes), Ke(3 n, 3 n, elements).  Strings end with c_null_char.
!> Compile this file with your program and link libhaptos_c.
module haptos
  use, intrinsic :: iso_c_binding
  implicit none
  public

  enum, bind(c)
    enumerator :: haptos_ok = 0, haptos_input_error = 1, haptos_not_converged = 2, haptos_no_solution = 3, &
                  haptos_internal_error = 70
  end enum
  enum, bind(c)
    enumerator :: haptos_frictionless = 0, haptos_tresca = 1, haptos_coulomb = 2, haptos_tied = 3
  end enum

  type, bind(c) :: haptos_friction
    integer(c_int) :: law = haptos_frictionless
    real(c_double) :: coefficients(2) = 0
    real(c_double) :: slip_bound = 0
  end type

  type, bind(c) :: haptos_subdomain
    integer(c_int) :: body, num_nodes
    type(c_ptr) :: nodes, coordinates, row_starts, columns, values
    integer(c_int) :: kernel_columns = 0
    type(c_ptr) :: kernel = c_null_ptr
  end type

  type, bind(c) :: haptos_pairs
    integer(c_int) :: interface, count
    type(c_ptr) :: secondary, primary_starts = c_null_ptr, primary = c_null_ptr, weights = c_null_ptr, normals, &
                   axes = c_null_ptr, gaps = c_null_ptr, areas = c_null_ptr
  end type

  type, bind(c) :: haptos_outcome
    integer(c_int) :: solved
    integer(c_int64_t) :: multiplications
    real(c_double) :: residual
    character(kind=c_char) :: method(64), reason(512)
  end type

  type, bind(c) :: haptos_counters
    integer(c_int64_t) :: factorizations, multiplications, rows
  end type

  interface
    integer(c_int) function haptos_create(comm, parameters, system) bind(c, name="haptos_create_fortran")
      import :: c_int, c_char, c_ptr
      integer(c_int), value :: comm                       !< a communicator of module mpi, or comm%mpi_val of mpi_f08
      character(kind=c_char), intent(in) :: parameters(*)
      type(c_ptr), intent(out) :: system
    end function
    integer(c_int) function haptos_destroy(system) bind(c)
      import :: c_int, c_ptr
      type(c_ptr), intent(inout) :: system
    end function
    type(c_ptr) function haptos_message_pointer(system) bind(c, name="haptos_message")
      import :: c_ptr
      type(c_ptr), value :: system
    end function
    integer(c_int) function haptos_add_interface(system, name, friction, number) bind(c)
      import :: c_int, c_char, c_ptr, haptos_friction
      type(c_ptr), value :: system
      character(kind=c_char), intent(in) :: name(*)
      type(haptos_friction), intent(in) :: friction
      integer(c_int), intent(out) :: number
    end function
    integer(c_int) function haptos_add_subdomain(system, subdomain, number) bind(c)
      import :: c_int, c_ptr, haptos_subdomain
      type(c_ptr), value :: system
      type(haptos_subdomain), intent(in) :: subdomain
      integer(c_int), intent(out) :: number
    end function
    integer(c_int) function haptos_add_nodes(system, count, nodes, coordinates) bind(c)
      import :: c_int, c_int64_t, c_double, c_ptr
      type(c_ptr), value :: system
      integer(c_int64_t), value :: count
      integer(c_int64_t), intent(in) :: nodes(*)
      real(c_double), intent(in) :: coordinates(3, *)
    end function
    integer(c_int) function haptos_add_elements(system, body, count, nodes_per_element, nodes, Ke) bind(c)
      import :: c_int, c_int64_t, c_double, c_ptr
      type(c_ptr), value :: system
      integer(c_int), value :: body, nodes_per_element
      integer(c_int64_t), value :: count
      integer(c_int64_t), intent(in) :: nodes(nodes_per_element, *)
      real(c_double), intent(in) :: Ke(*)
    end function
    integer(c_int) function haptos_prescribe(system, count, nodes, components, values) bind(c)
      import :: c_int, c_int64_t, c_double, c_ptr
      type(c_ptr), value :: system
      integer(c_int64_t), value :: count
      integer(c_int64_t), intent(in) :: nodes(*)
      integer(c_int), intent(in) :: components(*)
      real(c_double), intent(in) :: values(*)
    end function
    integer(c_int) function haptos_clear_prescribed(system) bind(c)
      import :: c_int, c_ptr
      type(c_ptr), value :: system
    end function
    integer(c_int) function haptos_add_pairs(system, pairs) bind(c)
      import :: c_int, c_ptr, haptos_pairs
      type(c_ptr), value :: system
      type(haptos_pairs), intent(in) :: pairs
    end function
    integer(c_int) function haptos_clear_pairs(system) bind(c)
      import :: c_int, c_ptr
      type(c_ptr), value :: system
    end function
    integer(c_int) function haptos_set_loads(system, count, nodes, forces) bind(c)
      import :: c_int, c_int64_t, c_double, c_ptr
      type(c_ptr), value :: system
      integer(c_int64_t), value :: count
      integer(c_int64_t), intent(in) :: nodes(*)
      real(c_double), intent(in) :: forces(3, *)
    end function
    integer(c_int) function haptos_set_gaps(system, count, pairs, gaps) bind(c)
      import :: c_int, c_double, c_ptr
      type(c_ptr), value :: system
      integer(c_int), value :: count
      integer(c_int), intent(in) :: pairs(*)
      real(c_double), intent(in) :: gaps(*)
    end function
    integer(c_int) function haptos_set_friction(system, number, friction) bind(c)
      import :: c_int, c_ptr, haptos_friction
      type(c_ptr), value :: system
      integer(c_int), value :: number
      type(haptos_friction), intent(in) :: friction
    end function
    integer(c_int) function haptos_set_stiffness(system, subdomain, values) bind(c)
      import :: c_int, c_double, c_ptr
      type(c_ptr), value :: system
      integer(c_int), value :: subdomain
      real(c_double), intent(in) :: values(*)
    end function
    integer(c_int) function haptos_set_elements(system, first, count, Ke) bind(c)
      import :: c_int, c_int64_t, c_double, c_ptr
      type(c_ptr), value :: system
      integer(c_int64_t), value :: first, count
      real(c_double), intent(in) :: Ke(*)
    end function
    integer(c_int) function haptos_set_up(system) bind(c)
      import :: c_int, c_ptr
      type(c_ptr), value :: system
    end function
    integer(c_int) function haptos_solve(system, outcome) bind(c)
      import :: c_int, c_ptr, haptos_outcome
      type(c_ptr), value :: system
      type(haptos_outcome), intent(out) :: outcome
    end function
    integer(c_int) function haptos_displacements(system, count, nodes, u) bind(c)
      import :: c_int, c_int64_t, c_double, c_ptr
      type(c_ptr), value :: system
      integer(c_int64_t), value :: count
      integer(c_int64_t), intent(in) :: nodes(*)
      real(c_double), intent(out) :: u(3, *)
    end function
    integer(c_int) function haptos_contact_forces(system, forces) bind(c)
      import :: c_int, c_double, c_ptr
      type(c_ptr), value :: system
      real(c_double), intent(out) :: forces(3, *)
    end function
    integer(c_int) function haptos_multipliers(system, count, values) bind(c)
      import :: c_int, c_int64_t, c_ptr
      type(c_ptr), value :: system
      integer(c_int64_t), intent(out) :: count
      type(c_ptr), value :: values                        !< c_loc of count values, or c_null_ptr for the count alone
    end function
    integer(c_int) function haptos_count(system, counters) bind(c)
      import :: c_int, c_ptr, haptos_counters
      type(c_ptr), value :: system
      type(haptos_counters), intent(out) :: counters
    end function
  end interface

contains

  !> What haptos_message() tells, as a string of Fortran.
  function haptos_text(system) result(text)
    type(c_ptr), value :: system
    character(len=:), allocatable :: text
    character(kind=c_char), pointer :: letters(:)
    type(c_ptr) :: pointer
    integer :: length
    pointer = haptos_message_pointer(system)
    call c_f_pointer(pointer, letters, [100000])
    length = 0
    do while (letters(length + 1) /= c_null_char)
      length = length + 1
    end do
    allocate (character(len=length) :: text)
    text = transfer(letters(1:length), text)
  end function
end module
