tubecert-certificate 1 radius
curve 106246579a25872412bb76b40bc56367db71df56c5ec5daed20c075f8755b76b
lo 49999999979999993/100000000000000000
hi 1/2
along
/
curved
curved
pairs
/
cone 218 -135 0
1
2
side 1 0
slab -3 0 0
2
1
side 1 0
cone 255 21 0
side 0 1
cone 218 135 0
start 776966883 -480191942 0
/
local
slab 3 -1 0
finish 776966883 480191942 0
/
local
slab -3 -1 0
upper curvature 0 1/2
end
