! What a Fortran compiler's read(nml=) makes of namelist files: reads their paths
! from standard input, one a line, and prints for each the status and, bit for bit,
! the values of one fixed group &sample. test_oracle.cpp holds the same group.
program oracle
  use, intrinsic :: iso_fortran_env, only: int64, real64, iostat_end
  implicit none
  real(real64) :: r, r2, ra(8), inf
  integer(int64) :: i, j, ia(8)
  logical :: flag, flag2
  character(len=24) :: s, t, sa(4)
  namelist /sample/ r, r2, ra, inf, i, j, ia, flag, flag2, s, t, sa
  character(len=1024) :: path, message
  integer :: status, unit

  do
    read (*, '(a)', iostat=status) path
    if (status /= 0) exit
    call set_defaults()
    message = ''
    open (newunit=unit, file=trim(path), status='old', action='read')
    read (unit, nml=sample, iostat=status, iomsg=message)
    close (unit)
    write (*, '(2a)') 'file ', trim(path)
    write (*, '(a,i0,2a)') 'status ', status, ' ', trim(message)
    call print_values()
  end do

contains

  subroutine set_defaults()
    integer :: k
    r = -1.5_real64
    r2 = -2.5_real64
    inf = -3.5_real64
    ra = [(-0.25_real64*k, k=1, 8)]
    i = -101
    j = -102
    ia = [(-10_int64*k, k=1, 8)]
    flag = .false.
    flag2 = .true.
    s = 'default s'
    t = 'default t'
    sa = ['first ', 'second', 'third ', 'fourth']
  end subroutine set_defaults

  subroutine print_values()
    integer :: k
    write (*, '(a,11(1x,z16.16))') 'reals', transfer([r, r2, inf, ra], [0_int64])
    write (*, '(a,10(1x,i0))') 'integers', i, j, ia
    write (*, '(a,2(1x,l1))') 'logicals', flag, flag2
    call print_string(s)
    call print_string(t)
    do k = 1, size(sa)
      call print_string(sa(k))
    end do
  end subroutine print_values

  subroutine print_string(text)
    character(len=*), intent(in) :: text
    integer :: k
    write (*, '(a)', advance='no') 'string '
    do k = 1, len_trim(text)
      write (*, '(z2.2)', advance='no') ichar(text(k:k))
    end do
    write (*, '(a)') ''
  end subroutine print_string
end program oracle
