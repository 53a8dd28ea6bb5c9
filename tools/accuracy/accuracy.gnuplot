# Worst rounding error against λ and against α, from the points of measure_accuracy:
#   gnuplot -e "table='accuracy.csv'" -e "image='accuracy.png'" accuracy.gnuplot
set terminal pngcairo size 1100,900 font "sans,12" enhanced
set output image
functions = "'BackboneForce double' 'SteadyLoopEnergy, Masing double' 'EvaluateForce double' \
'NormalizedResponse, α double'"
titles = "'f(x), scalar' 'W, Masing loop' 'T, response' '∂T/∂α (of Tc)'"
exponents = "'0' '10^{-300}' '10^{-16}' '10^{-8}' '0.1' '1/3' '1/2' '1−10^{-8}' '1−10^{-15}' '1' \
'1+10^{-15}' '1+10^{-8}' '2' '10' '100'"
# The worst by the key in field `key` of the rows of one function, in the order of the file.
worst(function, key) = sprintf("< awk -F, -v want='%s' -v key=%d \
'{ name = $1; for (i = 2; i <= NF - 3; ++i) name = name \",\" $i; k = $(NF - 3 + key); \
if (name == want) { if (!(k in at)) { order[++n] = k; at[k] = 0 } if ($NF + 0 > at[k]) at[k] = $NF + 0 } } \
END { for (i = 1; i <= n; ++i) print i, order[i], at[order[i]] }' '%s'", function, key, table)
set multiplot layout 2,1
set logscale y
set yrange [0.05:40]
set ylabel "worst error [ε of the type]"
set grid ytics xtics lc rgb "#dddddd" lt 1
set key top left horizontal samplen 2 width 1
colours = "'#1b6ca8' '#2a9d3a' '#c0392b' '#e08e0b' '#7d3c98'"
set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead dt 2 lc rgb "#888888"

set title "against λ = x/δ_c (σx/T_c for α ≥ 1), worst over all α and scales"
set logscale x
set xlabel "λ"
set format x "10^{%L}"
set xtics 1e-18, 1000
set xrange [1e-18:1e12]
plot for [i=1:words(functions)] worst(word(functions, i), 2) using 2:($3 > 0 ? $3 : 1/0) \
  with points pt 7 ps 0.6 lc rgb word(colours, i) title word(titles, i)

set title "against α, worst over all λ and scales"
unset logscale x
unset key
set xlabel "α"
set xrange [0.5:15.5]
set format x "%s"
set xtics rotate by 0 font "sans,9"
set xtics ()
do for [i=1:words(exponents)] { set xtics add (word(exponents, i) i) }
plot for [i=1:words(functions)] worst(word(functions, i), 1) using 1:($3 > 0 ? $3 : 1/0) \
  with linespoints pt 7 ps 1 lw 1.5 lc rgb word(colours, i) notitle
unset multiplot
