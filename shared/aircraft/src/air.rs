//! The air: how it thins with the altitude, by the International Standard Atmosphere (ISO 2533) below its tropopause.

/// Fall of the temperature, as a share of the 288.15 K at sea level, per metre (6.5 K/km).
const LAPSE_PER_M: f64 = 2.255_77e-5;
/// The density is the temperature's share to the power of this.
const DENSITY_EXPONENT: f64 = 4.255_88;
/// The temperature falls up to here, metres AMSL.
const TROPOPAUSE_M: f64 = 11_000.0;

/// Temperature at an altitude (metres AMSL) as a share of that at sea level.
pub fn temperature_share(altitude_amsl_m: f64) -> f64 {
    1.0 - LAPSE_PER_M * altitude_amsl_m.min(TROPOPAUSE_M)
}

/// True airspeed for each m/s of indicated airspeed at an altitude, metres AMSL: √(ρ₀/ρ).
///
/// A pitot tube measures ½·ρ·V², and its instrument takes the air for that at sea level. Compressibility is left out: it is
/// less than 0.2 % below 60 m/s.
pub fn true_per_indicated(altitude_amsl_m: f64) -> f64 {
    temperature_share(altitude_amsl_m).powf(-0.5 * DENSITY_EXPONENT)
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
            let share = true_per_indicated(altitude_m);
            assert!((share - expected).abs() < 1e-3, "{altitude_m} m: {share} for {expected}");
        }
    }
}
