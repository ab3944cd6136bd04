//! The air: how it thins with the altitude, by the International Standard Atmosphere (ISO 2533) below its tropopause, and on a day that
//! is warmer or colder.

/// Fall of the temperature, as a share of the 288.15 K at sea level, per metre (6.5 K/km).
const LAPSE_PER_M: f64 = 2.255_77e-5;
/// The density is the temperature's share to the power of this.
const DENSITY_EXPONENT: f64 = 4.255_88;
/// The temperature falls up to here, metres AMSL.
const TROPOPAUSE_M: f64 = 11_000.0;
/// Temperature at sea level, kelvin; that of 0 °C; and the density there, kg/m³.
const SEA_LEVEL_K: f64 = 288.15;
const ZERO_C_K: f64 = 273.15;
const SEA_LEVEL_KG_PER_M3: f64 = 1.225;
/// Specific gas constant of dry air, J/(kg·K).
const GAS_J_PER_KG_K: f64 = 287.053;
/// No weather is farther from the standard; a barometer in its box may be, °C.
pub const MOST_DEVIATION_C: f64 = 40.0;

/// Temperature at an altitude (metres AMSL) as a share of that at sea level.
pub fn temperature_share(altitude_amsl_m: f64) -> f64 {
    1.0 - LAPSE_PER_M * altitude_amsl_m.min(TROPOPAUSE_M)
}

/// True airspeed for each m/s of indicated airspeed at an altitude, metres AMSL: √(ρ₀/ρ). The air is so much warmer there than the
/// standard's, °C, at the standard's pressure.
///
/// A pitot tube measures ½·ρ·V², and its instrument takes the air for that at sea level. Compressibility is left out: it is
/// less than 0.2 % below 60 m/s.
pub fn true_per_indicated(altitude_amsl_m: f64, isa_deviation_c: f64) -> f64 {
    let share = temperature_share(altitude_amsl_m);
    (share.powf(-DENSITY_EXPONENT) * (1.0 + isa_deviation_c / (share * SEA_LEVEL_K))).sqrt()
}

/// How much warmer than the standard's air of the density that was measured is at an altitude (metres AMSL), °C. `None`: no weather
/// makes it so, or it is no measurement.
pub fn isa_deviation_c(altitude_amsl_m: f64, pressure_hpa: f64, temperature_c: f64) -> Option<f64> {
    let share = temperature_share(altitude_amsl_m);
    let standard = SEA_LEVEL_KG_PER_M3 * share.powf(DENSITY_EXPONENT);
    let measured = 100.0 * pressure_hpa / (GAS_J_PER_KG_K * (ZERO_C_K + temperature_c));
    let deviation_c = share * SEA_LEVEL_K * (standard / measured - 1.0);
    (-MOST_DEVIATION_C..=MOST_DEVIATION_C).contains(&deviation_c).then_some(deviation_c)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Densities of the standard's table, kg/m³.
    #[test]
    fn true_airspeed_follows_the_densities_of_the_standard_atmosphere() {
        for (altitude_m, density) in
            [(-500.0, 1.2849), (0.0, 1.2250), (1000.0, 1.1117), (3000.0, 0.9093), (11_000.0, 0.3639)]
        {
            let expected = (1.225_f64 / density).sqrt();
            let share = true_per_indicated(altitude_m, 0.0);
            assert!((share - expected).abs() < 1e-3, "{altitude_m} m: {share} for {expected}");
        }
    }

    /// 35 °C at sea level, and -5 °C: 1.1455 and 1.3164 kg/m³.
    #[test]
    fn warm_air_is_thin_and_cold_air_dense() {
        for (isa_deviation_c, density) in [(20.0, 1.1455), (-20.0, 1.3164)] {
            let share = true_per_indicated(0.0, isa_deviation_c);
            assert!((share - (1.225_f64 / density).sqrt()).abs() < 1e-3, "{isa_deviation_c}: {share}");
        }
    }

    #[test]
    fn what_is_measured_is_the_air_that_it_is_flown_in() {
        // the standard's at 500 m, and what is twenty degrees warmer
        for (temperature_c, expected_c) in [(11.75, 0.0), (31.75, 20.0), (-18.25, -30.0)] {
            let found_c = isa_deviation_c(500.0, 954.61, temperature_c);
            assert!(found_c.is_some_and(|c| (c - expected_c).abs() < 0.1), "{temperature_c}: {found_c:?}");
        }
        for (pressure_hpa, temperature_c) in
            [(0.0, 0.0), (954.61, f64::NAN), (f64::NAN, 15.0), (954.61, 60.0), (954.61, -60.0), (500.0, 15.0)]
        {
            assert_eq!(isa_deviation_c(500.0, pressure_hpa, temperature_c), None);
        }
    }
}
