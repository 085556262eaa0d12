! SPDX-License-Identifier: BSD-3-Clause
!> A stranger's Fortran program on an installed Haptos: the two beams of beams.c, as elements that Haptos cuts.
!> Writes x y z ux uy uz of all nodes to the file that is its argument.
program beams
  use mpi
  use haptos
  implicit none
  integer, parameter :: m = 4, nx = 2 * m, nodes_of_beam = (nx + 1) * (m + 1)**2, contacts = (nx + 1) * (m + 1)
  real(c_double), parameter :: h = 1d0 / m
  real(c_double), parameter :: materials(2, 2) = reshape([6.9d4, 0.333d0, 2.119d5, 0.277d0], [2, 2])
  character(len=*), parameter :: parameters = "<ParameterList name='Haptos'><ParameterList name='Solver'>" // &
    "<Parameter name='Relative Tolerance' type='double' value='1e-11'/></ParameterList></ParameterList>"
  type(c_ptr) :: system
  type(haptos_outcome) :: outcome
  integer :: rank, ranks, comm, error
  integer(c_int) :: number
  character(len=256) :: file

  call MPI_Init(error)
  call MPI_Comm_rank(MPI_COMM_WORLD, rank, error)
  call MPI_Comm_split(MPI_COMM_WORLD, merge(0, MPI_UNDEFINED, rank < 2), rank, comm, error)
  if (comm /= MPI_COMM_NULL) call solve()
  call MPI_Finalize(error)

contains

  !> By two of the ranks at most; the others have something else to do.
  subroutine solve()
    call MPI_Comm_size(comm, ranks, error)
    call check(haptos_create(comm, parameters // c_null_char, system))
    call check(haptos_add_interface(system, "joint" // c_null_char, haptos_friction(haptos_coulomb, [0.3d0, 0.15d0]), number))
    call add_elements()
    if (rank == 0) call add_contact()
    if (rank == 0) call set_loads()
    call try_mistake()
    call check(haptos_solve(system, outcome))
    call read_multipliers()
    call get_command_argument(1, file)
    call write_field()
    if (rank == 0) print "(a, i0, a, i0, a)", "Fortran on ", ranks, " ranks: solved in ", outcome%multiplications, &
      " multiplications"
    call check(haptos_destroy(system))
    call MPI_Comm_free(comm, error)
  end subroutine

  subroutine check(status)
    integer(c_int), intent(in) :: status
    if (status == haptos_ok) return
    print *, "status", status, haptos_text(system)
    call MPI_Abort(MPI_COMM_WORLD, 1, error)
  end subroutine

  pure integer(c_int64_t) function id(body, i, j, k)
    integer, intent(in) :: body, i, j, k
    id = 5000 * body + (k * (m + 1) + j) * (nx + 1) + i
  end function

  pure function place(body, i, j, k) result(x)
    integer, intent(in) :: body, i, j, k
    real(c_double) :: x(3)
    x = [i * h, j * h, k * h + body - 1]
  end function

  !> Brick of the side h, nodes numbered by bits of x, y, z; 2 x 2 x 2 Gauss points.
  pure function brick(material) result(K)
    real(c_double), intent(in) :: material(2)
    real(c_double) :: K(24, 24), d(3, 0:7), lame, shear, s(3, 0:7)
    integer :: p, n, q, a, b
    lame = material(1) * material(2) / ((1 + material(2)) * (1 - 2 * material(2)))
    shear = material(1) / (2 * (1 + material(2)))
    K = 0
    do n = 0, 7
      s(:, n) = [(merge(1d0, -1d0, btest(n, a)), a=0, 2)]
    end do
    do p = 0, 7
      do n = 0, 7
        do a = 1, 3
          d(a, n) = s(a, n) / (4 * h)
          do b = 1, 3
            if (b /= a) d(a, n) = d(a, n) * (1 + s(b, n) * s(b, p) / sqrt(3d0))
          end do
        end do
      end do
      do n = 0, 7
        do q = 0, 7
          do a = 1, 3
            do b = 1, 3
              K(3 * n + a, 3 * q + b) = K(3 * n + a, 3 * q + b) + h**3 / 8 * (lame * d(a, n) * d(b, q) + shear * d(b, n) * d(a, q))
              if (a == b) K(3 * n + a, 3 * q + b) = K(3 * n + a, 3 * q + b) + h**3 / 8 * shear * dot_product(d(:, n), d(:, q))
            end do
          end do
        end do
      end do
    end do
  end function

  !> Elements are dealt to the ranks in turn.
  subroutine add_elements()
    integer :: body, i, j, k, n, e
    integer(c_int64_t) :: nodes(8)
    real(c_double) :: places(3, 8), Ke(24, 24)
    e = 0
    do body = 0, 1
      Ke = brick(materials(:, body + 1))
      do k = 0, m - 1
        do j = 0, m - 1
          do i = 0, nx - 1
            e = e + 1
            if (mod(e, ranks) /= rank) cycle
            do n = 0, 7
              nodes(n + 1) = id(body, i + ibits(n, 0, 1), j + ibits(n, 1, 1), k + ibits(n, 2, 1))
              places(:, n + 1) = place(body, i + ibits(n, 0, 1), j + ibits(n, 1, 1), k + ibits(n, 2, 1))
            end do
            call check(haptos_add_nodes(system, 8_c_int64_t, nodes, places))
            call check(haptos_add_elements(system, body, 1_c_int64_t, 8_c_int, nodes, Ke))
          end do
        end do
      end do
    end do
  end subroutine

  subroutine add_contact()
    integer(c_int64_t), target :: upper(contacts), lower(contacts)
    real(c_double), target :: normals(3, contacts)
    type(haptos_pairs) :: pairs
    integer :: body, i, j, k, n
    n = 0
    do j = 0, m
      do i = 0, nx
        n = n + 1
        upper(n) = id(1, i, j, 0)
        lower(n) = id(0, i, j, m)
        normals(:, n) = [0d0, 0d0, -1d0]
      end do
    end do
    pairs = haptos_pairs(interface=number, count=contacts, secondary=c_loc(upper), primary=c_loc(lower), normals=c_loc(normals))
    call check(haptos_add_pairs(system, pairs))
    do body = 0, 1
      do k = 0, m
        do j = 0, m
          call check(haptos_prescribe(system, 3_c_int64_t, spread(id(body, 0, j, k), 1, 3), &
                                      [0_c_int, 1_c_int, 2_c_int], [0d0, 0d0, 0d0]))
        end do
      end do
    end do
  end subroutine

  !> A quarter of the load of every face on each of its nodes: pressure 100 on top, traction (20, 20, 0) at the end.
  subroutine set_loads()
    integer(c_int64_t) :: nodes(4 * (nx * m + m * m))
    real(c_double) :: forces(3, 4 * (nx * m + m * m))
    integer :: i, j, k, n, count
    count = 0
    forces = 0
    do j = 0, m - 1
      do n = 0, 3
        do i = 0, nx - 1
          count = count + 1
          nodes(count) = id(1, i + ibits(n, 0, 1), j + ibits(n, 1, 1), m)
          forces(3, count) = -100 * h**2 / 4
        end do
        do k = 0, m - 1
          count = count + 1
          nodes(count) = id(1, nx, j + ibits(n, 0, 1), k + ibits(n, 1, 1))
          forces(1:2, count) = 20 * h**2 / 4
        end do
      end do
    end do
    call check(haptos_set_loads(system, int(count, c_int64_t), nodes, forces))
  end subroutine

  !> Of one rank; all are told, and the next call works.
  subroutine try_mistake()
    integer(c_int) :: status
    if (rank == 0) status = haptos_prescribe(system, 1_c_int64_t, [1_c_int64_t], [7_c_int], [0d0])
    status = haptos_set_up(system)
    if (status == haptos_input_error .and. index(haptos_text(system), "Component 7") > 0) return
    print *, "a wrong component was not refused:", status, haptos_text(system)
    call MPI_Abort(MPI_COMM_WORLD, 1, error)
  end subroutine

  !> How many, and then all of them: the beams press on each other.
  subroutine read_multipliers()
    integer(c_int64_t) :: count
    real(c_double), allocatable, target :: values(:)
    real(c_double) :: largest, all
    call check(haptos_multipliers(system, count, c_null_ptr))
    allocate (values(count))
    call check(haptos_multipliers(system, count, c_loc(values)))
    largest = maxval(abs([0d0, values]))
    call MPI_Allreduce(largest, all, 1, MPI_DOUBLE_PRECISION, MPI_MAX, comm, error)
    if (all > 0 .and. size(values) == count) return
    print *, "there are no multipliers:", count, all
    call MPI_Abort(MPI_COMM_WORLD, 1, error)
  end subroutine

  subroutine write_field()
    integer(c_int64_t) :: nodes(2 * nodes_of_beam)
    real(c_double) :: u(3, 2 * nodes_of_beam), places(3, 2 * nodes_of_beam)
    integer :: body, i, j, k, n, unit
    n = 0
    do body = 0, 1
      do k = 0, m
        do j = 0, m
          do i = 0, nx
            n = n + 1
            nodes(n) = id(body, i, j, k)
            places(:, n) = place(body, i, j, k)
          end do
        end do
      end do
    end do
    call check(haptos_displacements(system, int(n, c_int64_t), nodes, u))
    if (rank /= 0) return
    open (newunit=unit, file=file, action="write")
    do i = 1, n
      write (unit, "(6es26.17)") places(:, i), u(:, i)
    end do
    close (unit)
  end subroutine
end program
