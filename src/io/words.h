#pragma once

#include <array>
#include <string_view>

#include "io/columns.h"

namespace mindahl::io {

/// A row of the words by which columns are recognised: those of lower rank are better evidence.
struct WordRow {
  Role role;
  int rank;
  std::string_view words;   ///< separated by '|'; '*' stands for any beginning of a word
  bool is_angular = false;  // of an angle or a torque
};

// The ranks of a machine's load, which is the normal load if there is another force, and of what is
// a force only when it is multiplied by a load.
inline constexpr int kLoad = 2;
inline constexpr int kRatio = 6;

// One-letter words count as they are written, and only as a whole name.
inline constexpr auto kWords = std::to_array<WordRow>({
    {Role::kDisplacement, 0,
     "tangential displacement|relative displacement|slip displacement|sliding displacement"},
    {Role::kDisplacement, 1,
     "displacement|disp|displ|extensometer|*wegaufnehmer|*verschiebung|déplacement|deplacement|"
     "desplazamiento|spostamento|deslocamento|位移|変位"},
    {Role::kDisplacement, 2,
     "position|pos|travel|stroke|extension|lvdt|deflection|elongation|crosshead|qpos|*weg|"
     "*auslenkung|*hub|course|allongement|posición|posicion|carrera|recorrido|posizione|corsa|"
     "posição|posicao|curso|行程|位置|变形|伸び|ストローク"},
    {Role::kDisplacement, 3, "x|X|d|u|U|u u|delta|δ|Δ|ux|uy|dx"},
    {Role::kDisplacement, 4,
     "angle|rotation|twist|theta|θ|phi|φ|q|winkel|drehwinkel|ángulo|angulo|angolo|角度|转角|"
     "回転角",
     true},
    {Role::kForce, 0,
     "tangential force|friction force|lateral force|shear force|frictional force|tangentialkraft|"
     "reibkraft|reibungskraft|querkraft|force tangentielle|effort tangentiel|force de frottement|"
     "fuerza de fricción|fuerza tangencial|forza di attrito|forza tangenziale|força de atrito|"
     "força tangencial|摩擦力|切向力|接線力|せん断力"},
    {Role::kForce, 0, "friction torque|reibmoment", true},
    {Role::kForce, 1,
     "force|friction|*kraft|effort|fuerza|forza|força|forca|力|loadcell|ロードセル"},
    {Role::kForce, kLoad, "load|last|charge|carga|carico|weight|gewicht|载荷|荷载|荷重"},
    {Role::kForce, 2, "torque|moment|*drehmoment|couple|coppia|par|tau|τ|扭矩|力矩|トルク", true},
    {Role::kForce, 3, "ft|f t|fh|fx|fy|fr|rf|fs"},
    {Role::kForce, 4, "F|f|Q|P"},
    {Role::kForce, 5, "T"},
    {Role::kTime, 0,
     "time|timestamp|time stamp|elapsed|*zeit|zeitstempel|temps|tiempo|tempo|时间|時間|時刻"},
    {Role::kTime, 1,
     "t|ms|millis|micros|nanos|seconds|secs|sec|msec|stamp|clock|datetime|date|datum|uhrzeit|"
     "fecha|hora|heure"},
    {Role::kTime, 2, "x value"},
    {Role::kNormalLoad, 0,
     "normal load|normal force|*normalkraft|*anpresskraft|*anpreßkraft|charge normale|"
     "force normale|effort normal|fuerza normal|carga normal|forza normale|carico normale|"
     "força normal|法向力|法向载荷|法向荷载|正压力|垂直力|垂直荷重|押付力|押付け力|clamp force|"
     "clamping force|clamp load|clamping load|*klemmkraft|*vorspannkraft"},
    {Role::kNormalLoad, 1, "normal|n load|normallast"},
    {Role::kNormalLoad, 2, "fn|f n|N"},
    {Role::kOther, 0,
     "cycle|cycles|count|counts|counter|index|idx|sample|samples|step|steps|row|no|nr|seq|id|"
     "block|segment|point|*zyklus|*zyklen|*zähler|compteur|ciclo|ciclos|cicli|cycle count|"
     "step time|recuento|n|#|序号|循环|周期|サイクル|番号|velocity|speed|vel|v|dq|qd|qvel|rate|"
     "acceleration|accel|acc|*geschwindigkeit|vitesse|velocidad|velocità|velocidade|速度|加速度|"
     "*beschleunigung|temperature|temp|*temperatur|température|temperatura|voltage|pressure|"
     "*druck|strain|stress|*dehnung|*spannung|energy|work|power|frequency|humidity|温度|压力|"
     "current|strom|stiffness|tangential stiffness|contact stiffness|secant stiffness|"
     "tangent stiffness|compliance|contact compliance"},
    {Role::kForce, kRatio,
     "coefficient of friction|friction coefficient|coef of friction|coeff of friction|"
     "friction coeff|q p|ft fn|cof|mu|µ|μ|reibwert|reibbeiwert|reibungszahl|reibzahl|"
     "*reibkoeffizient|*reibungskoeffizient|coefficient de frottement|coeficiente de fricción|"
     "coeficiente de friccion|coeficiente de rozamiento|coeficiente de atrito|"
     "coefficiente di attrito|摩擦系数|摩擦係数|коэффициент трения|마찰계수"},
    {Role::kOther, 1, "kt|k|K"},
});

// Commanded, raw and statistical quantities are weaker evidence than measured ones.
inline constexpr std::string_view kLesserWords =
    "setpoint|set|goal|demand|command|cmd|commanded|target|desired|reference|ref|control|soll|"
    "sollwert|consigne|consigna|raw|adc|min|max|peak|error|err|volt|volts|zero|offset|normalized";

// These words say that a quantity has no unit.
inline constexpr std::string_view kRatios =
    "normalized|normalised|normalisiert|normiert|percent|prozent|pct|ratio";

}  // namespace mindahl::io
